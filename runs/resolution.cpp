#include "runs/resolution.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "runs/depth.h"

namespace flowrest::runs {

Row Resolution::add(double time, const ShearedLayer& layer) {
  const bool sheared = layer.thickness > 0.0;
  Row row;
  row.add(column::sheared_layer, sheared ? layer.thickness : nothing)
      .add(column::sheared_layer_cells, sheared ? layer.cells : nothing)
      .add(column::mean_shear_rate, sheared ? layer.mean_rate : nothing);
  hold(time, row.values()[0], row.values()[1], row.values()[2]);
  return row;
}

/// By what the row says, so that a run that is gone on with knows the same.
void Resolution::hold(double time, double thickness_mm, double cells, double mean_rate) {
  const ShearedLayer layer{1e-3 * thickness_mm, cells, mean_rate};
  const double strain = layer.mean_rate * (time - last_);
  last_ = time;
  if (layer.thickness > 0.0 && strain > 0.0) moments_.push_back({time, layer, strain});
}

void Resolution::continue_from(const Table& history) {
  const auto& time = history.at(column::time.name);
  const auto &thickness = history.at(column::sheared_layer.name),
             &cells = history.at(column::sheared_layer_cells.name),
             &rate = history.at(column::mean_shear_rate.name);
  for (std::size_t i = 0; i < time.size(); ++i) hold(time[i], thickness[i], cells[i], rate[i]);
}

std::optional<Resolution::Moment> Resolution::judged() const {
  if (moments_.empty()) return std::nullopt;
  std::vector<const Moment*> by_cells;
  double total = 0.0;
  for (const Moment& moment : moments_) {
    by_cells.push_back(&moment);
    total += moment.strain;
  }
  std::stable_sort(by_cells.begin(), by_cells.end(),
                   [](const Moment* a, const Moment* b) { return a->layer.cells < b->layer.cells; });
  double below = 0.0;
  for (const Moment* moment : by_cells)
    if ((below += moment->strain) >= 0.5 * total) return *moment;
  return *by_cells.back();
}

std::string Resolution::fault(double passage_cells, std::optional<double> depth_cells) const {
  std::vector<std::string> faults;
  if (const auto moment = judged(); moment && moment->layer.cells < cells_wanted)
    faults.push_back(
        fmt::format("{:.1f} cells over the sheared layer of {:.3g} mm at {:.3g} s, where {:g} are wanted",
                    moment->layer.cells, 1e3 * moment->layer.thickness, moment->time, cells_wanted));
  if (depth_cells && *depth_cells < cells_across_wanted)
    faults.push_back(fmt::format("{:.1f} cells over the depth at the centre", *depth_cells));
  if (passage_cells < cells_across_wanted)
    faults.push_back(fmt::format("{:.1f} cells across the narrowest passage", passage_cells));
  return fmt::format("{}", fmt::join(faults, ", "));
}

std::string Resolution::limit_of_rest() const {
  if (moments_.empty() || moments_.back().layer.cells >= 1.0) return "";
  const ShearedLayer& layer = moments_.back().layer;
  return fmt::format("limited by the cell: the sheared layer of {:.2g} mm is {:.2g} cells thick",
                     1e3 * layer.thickness, layer.cells);
}

nlohmann::ordered_json Resolution::json() const {
  const auto moment = judged();
  if (!moment) return nullptr;
  return {{"sheared_layer_m", moment->layer.thickness},
          {"cells", moment->layer.cells},
          {"wanted", cells_wanted},
          {"at_s", moment->time},
          {"cells_at_end", moments_.back().layer.cells}};
}

}  // namespace flowrest::runs
