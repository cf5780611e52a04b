#include "mpm/output/checkpoint.h"

#include <fmt/format.h>

#include <array>

#include "mpm/output/hdf5_file.h"
#include "runs/run_directory.h"

namespace flowrest::mpm {

namespace {

/// RunState as a row of numbers, and back: one list of members serves both.
template <class State, class Use>
void each_member(State& s, Use use) {
  for (auto* member : {&s.time,
                       &s.steps,
                       &s.step,
                       &s.largest_speed,
                       &s.largest_pressure,
                       &s.dissipated,
                       &s.work,
                       &s.initial_energy,
                       &s.calm_since,
                       &s.cpu,
                       &s.wall,
                       &s.histories,
                       &s.profiles,
                       &s.snapshots,
                       &s.checkpoints,
                       &s.last_profile,
                       &s.last_snapshot,
                       &s.noise.judged_until,
                       &s.stages.particles_to_grid,
                       &s.stages.nodes,
                       &s.stages.grid_to_particles,
                       &s.stages.sorting,
                       &s.stages.volumes})
    use(*member);
  for (auto* noise : {&s.noise.within_cells, &s.noise.between_steps})
    for (auto* member : {&noise->time, &noise->path, &noise->motion, &noise->first, &noise->last})
      use(*member);
}

std::filesystem::path file_in(const std::filesystem::path& directory) { return directory / "checkpoint.h5"; }

}  // namespace

void write_checkpoint(const std::filesystem::path& directory, const Checkpoint& c) {
  Hdf5File file = Hdf5File::create(file_in(directory));
  std::vector<double> run;
  each_member(c.run, [&](const double& v) { run.push_back(v); });
  file.write("/run", run);
  file.write("/noise_meter", c.noise_meter);
  file.attribute("/", "scene", c.scene);
  std::vector<std::int32_t> cells;
  for (const auto& cell : c.solver.cells) cells.insert(cells.end(), cell.begin(), cell.end());
  file.write("/cells", cells, 3);
  const std::array<std::int32_t, 3> sizes = {c.solver.tile_capacity,
                                             static_cast<std::int32_t>(c.solver.arrays.size()),
                                             static_cast<std::int32_t>(c.solver.wall_forces.size())};
  file.write("/sizes", sizes);
  for (std::size_t k = 0; k < c.solver.arrays.size(); ++k)
    file.write(fmt::format("/array{:02}", k), c.solver.arrays[k]);
  if (!c.solver.wall_forces.empty()) file.write("/wall_forces", c.solver.wall_forces);
  file.commit();
}

std::optional<Checkpoint> read_checkpoint(const std::filesystem::path& directory) {
  if (!std::filesystem::exists(file_in(directory))) return std::nullopt;
  const Hdf5File file = Hdf5File::open(file_in(directory));
  Checkpoint c;
  const std::vector<double> run = file.read_doubles("/run");
  std::size_t next = 0;
  each_member(c.run, [&](double& v) {
    v = next < run.size() ? run[next] : 0.0;
    ++next;
  });
  const auto damaged = [&](const std::string& what) {
    return runs::RunError(
        fmt::format("{}: {}; start the run over without --resume", file_in(directory).string(), what));
  };
  if (next != run.size())
    throw damaged(fmt::format("holds {} run values, {} are expected", run.size(), next));
  c.noise_meter = file.read_doubles("/noise_meter");
  c.scene = file.read_text("/", "scene");
  const auto cells = file.read_integers("/cells");
  c.solver.cells.resize(cells.size() / 3);
  for (std::size_t i = 0; i < cells.size(); ++i) c.solver.cells[i / 3][i % 3] = cells[i];
  const auto sizes = file.read_integers("/sizes");
  if (sizes.size() != 3) throw damaged("lacks its sizes");
  c.solver.tile_capacity = sizes[0];
  for (int k = 0; k < sizes[1]; ++k) {
    c.solver.arrays.push_back(file.read_doubles(fmt::format("/array{:02}", k)));
    if (c.solver.arrays.back().size() != c.solver.cells.size())
      throw damaged(fmt::format("array {} has the wrong length", k));
  }
  if (sizes[2] > 0) c.solver.wall_forces = file.read_doubles("/wall_forces");
  if (std::ssize(c.solver.wall_forces) != sizes[2]) throw damaged("lacks its walls' forces");
  return c;
}

}  // namespace flowrest::mpm
