#include "mpm/derivatives/gradient.h"
#include "mpm/derivatives/replay.h"

namespace flowrest::mpm::derivatives {

namespace {

/// Reads quantities off a replay: use(quantity, value, change), the change with its derivatives.
template <int Dim, class R, class Use>
void read(const R& replay, double time, const std::vector<Quantity>& quantities, const Use& use) {
  using T = typename R::T;
  const Variation& recorded = replay.source().recorded();
  std::vector<plain::Particle<double, Dim>> values;
  for (const auto& p : replay.body().particles())
    values.push_back(values_of<T, Dim>(p, recorded.settings.thixotropic));
  for (std::size_t q = 0; q < quantities.size(); ++q) {
    const Surroundings<T> around = surroundings_of(replay.source(), time, quantities[q]);
    const Linearised at(quantities[q], recorded, values, values_of(around));
    T change(0);
    for (const auto& p : replay.body().particles()) change += at.part<T, Dim>(p, around);
    use(q, at.value(), change);
  }
}

template <int N, int Dim>
void forward_by(const Variations& variations, std::size_t first, const Recording& recording,
                const std::vector<Quantity>& quantities, std::vector<Readings>& rows, const Watch& watch) {
  const DualSource<N> source(variations, first);
  Replay<DualSource<N>, Dim> replay(source, recording);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    replay.advance_to(recording.rows[r].steps);
    read<Dim>(replay, rows[r].time, quantities, [&](std::size_t q, double value, const Dual<N>& change) {
      rows[r].value[q] = value;
      for (std::size_t k = 0; k < source.count(); ++k) rows[r].slope[q][first + k] = change.d[k];
    });
    if (watch)
      watch((static_cast<double>(first) +
             static_cast<double>(source.count() * (r + 1)) / static_cast<double>(rows.size())) /
            static_cast<double>(variations.keys()));
  }
}

template <int Dim>
void forward_in(const Variations& variations, const Recording& recording,
                const std::vector<Quantity>& quantities, std::vector<Readings>& rows, const Watch& watch) {
  for (std::size_t first = 0; first < variations.keys();) {
    const std::size_t left = variations.keys() - first;
    const auto by = [&](auto width) {
      forward_by<width(), Dim>(variations, first, recording, quantities, rows, watch);
      first += width();
    };
    if (left == 1)
      by(std::integral_constant<int, 1>{});
    else if (left == 2)
      by(std::integral_constant<int, 2>{});
    else if (left <= 4)
      by(std::integral_constant<int, 4>{});
    else
      by(std::integral_constant<int, 8>{});
  }
}

template <int Dim>
std::vector<std::vector<double>> replayed_in(const Variation& of, const Variation& recorded,
                                             const Recording& recording,
                                             const std::vector<Quantity>& quantities, const Watch& watch) {
  Replay<PlainSource, Dim> replay(PlainSource(of, recorded), recording);
  std::vector<std::vector<double>> rows;
  for (const Recording::Row& row : recording.rows) {
    replay.advance_to(row.steps);
    auto& values = rows.emplace_back(quantities.size());
    read<Dim>(replay, row.time, quantities, [&](std::size_t q, double value, double) { values[q] = value; });
    if (watch) watch(static_cast<double>(rows.size()) / static_cast<double>(recording.rows.size()));
  }
  return rows;
}

}  // namespace

std::vector<Readings> forward(const Variations& variations, const Recording& recording,
                              const std::vector<Quantity>& quantities, const Watch& watch) {
  std::vector<Readings> rows;
  for (const Recording::Row& row : recording.rows)
    rows.push_back(
        {row.time, std::vector<double>(quantities.size()),
         std::vector<std::vector<double>>(quantities.size(), std::vector<double>(variations.keys()))});
  if (variations.centre().settings.dimension == 3)
    forward_in<3>(variations, recording, quantities, rows, watch);
  else
    forward_in<2>(variations, recording, quantities, rows, watch);
  return rows;
}

std::vector<std::vector<double>> replayed(const Variation& of, const Variation& recorded,
                                          const Recording& recording, const std::vector<Quantity>& quantities,
                                          const Watch& watch) {
  return recorded.settings.dimension == 3 ? replayed_in<3>(of, recorded, recording, quantities, watch)
                                          : replayed_in<2>(of, recorded, recording, quantities, watch);
}

}  // namespace flowrest::mpm::derivatives
