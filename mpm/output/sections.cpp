#include "mpm/output/sections.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "runs/bins.h"
#include "runs/csv.h"
#include "runs/output_file.h"

namespace flowrest::mpm {

SectionWriter::SectionWriter(const std::filesystem::path& directory, const scenes::Pieces& pieces,
                             double cell, double resume_time)
    : file_(directory / "sections.csv"), pieces_(pieces), cell_(cell) {
  const auto* gauge = std::get_if<scenes::SectionGauge>(&pieces.gauged);
  if (gauge && std::isfinite(gauge->behind)) gauge_ = *gauge;
  if (!gauge_) return;
  if (resume_time >= 0.0 && std::filesystem::exists(file_)) {
    last_ = runs::cut_csv_back(file_, resume_time).value_or(-1.0);
    return;
  }
  runs::OutputFile out(file_, true);
  out.append(std::string(header) + "\n");
  out.close();
}

/// A layer ends where the mouth was that laid it.
int SectionWriter::layer_of(double height, double time) const {
  int below = 0, begun = 0;
  for (const scenes::Feed& feed : pieces_.feeds) {
    if (time < feed.begins_at) continue;
    ++begun;
    if (feed.mouth(feed.begins_at)[2] <= height) ++below;
  }
  return std::min(below + 1, std::max(begun, 1));
}

void SectionWriter::write(double time, Solver& solver) {
  if (!gauge_ || time <= last_) return;
  last_ = time;
  // Stretches from where the first nozzle began, which way it goes.
  const scenes::Feed& first = pieces_.feeds.front();
  const double begin = first.mouth(first.begins_at)[0], length = gauge_->length;
  const double until = std::min(time, first.gone_at);
  const double way = first.mouth(until)[0] < begin ? -1.0 : 1.0;
  const double gone = way * (first.mouth(until)[0] - begin);
  const long stretches =
      static_cast<long>(std::floor((time < first.gone_at ? gone - gauge_->behind : gone) / length));
  if (stretches < 1) return;
  std::map<std::pair<long, long>, double> volume;  // by stretch and row
  solver.visit([&](const ParticleBatch& b) {
    for (std::size_t i = 0; i < b.count; ++i) {
      const long stretch = static_cast<long>(std::floor(way * (b.position[0][i] - begin) / length));
      if (stretch < 0 || stretch >= stretches) continue;
      const double extent = std::cbrt(b.volume[i]), z = b.position[2][i];
      const double from = (z - 0.5 * extent) / cell_, to = (z + 0.5 * extent) / cell_;
      runs::for_each_bin(from, to, [&](long row, double overlap) {
        volume[{stretch, row}] += b.volume[i] * overlap / (to - from);
      });
    }
  });
  const double half = 0.5 * pieces_.whole_over_computed / (length * cell_);
  std::string text;
  for (const auto& [at, own] : volume) {
    const double x = begin + way * (static_cast<double>(at.first) + 0.5) * length;
    const double z = (static_cast<double>(at.second) + 0.5) * cell_;
    text += fmt::format("{:.17g},{:.17g},{},{:.17g},{:.17g}\n", time, x, layer_of(z, time), z, half * own);
  }
  runs::OutputFile out(file_);
  out.append(text);
  out.close();
}

}  // namespace flowrest::mpm
