#include "mpm/output/checkpoint.h"

#include <fmt/format.h>

#include <array>
#include <memory>

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

std::string name_of_array(int array) { return fmt::format("/array{:02}", array); }

}  // namespace

void write_checkpoint(const std::filesystem::path& directory, const RunState& run, Solver& solver,
                      const std::string& scene, const std::vector<double>& noise_meter) {
  Hdf5File file = Hdf5File::create(file_in(directory));
  std::vector<double> values;
  each_member(run, [&](const double& v) { values.push_back(v); });
  file.write("/run", values);
  file.write("/noise_meter", noise_meter);
  file.attribute("/", "scene", scene);
  const std::size_t particles = solver.particle_count();
  Hdf5Rows<std::int32_t> cells(file, "/cells", particles, 3);
  solver.visit_cells([&](std::span<const CellIndex> some) {
    for (const CellIndex& cell : some)
      for (const std::int32_t c : cell) cells.add(c);
  });
  cells.finish();
  const std::vector<double> forces = solver.wall_forces();
  file.write("/sizes", std::array<std::int32_t, 3>{solver.tile_capacity(), solver.array_count(),
                                                   static_cast<std::int32_t>(forces.size())});
  for (int k = 0; k < solver.array_count(); ++k) {
    Hdf5Rows<double> array(file, name_of_array(k), particles);
    solver.visit_array(k, [&](std::span<const double> some) {
      for (const double v : some) array.add(v);
    });
    array.finish();
  }
  if (!forces.empty()) file.write("/wall_forces", forces);
  file.commit();
}

std::optional<Checkpoint> read_checkpoint(const std::filesystem::path& directory) {
  if (!std::filesystem::exists(file_in(directory))) return std::nullopt;
  const auto opened = std::make_shared<const Hdf5File>(Hdf5File::open(file_in(directory)));
  const Hdf5File& file = *opened;
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
  for (int k = 0; k < sizes[1]; ++k)
    if (file.size_of(name_of_array(k)) != c.solver.cells.size())
      throw damaged(fmt::format("array {} has the wrong length", k));
  c.solver.array_count = sizes[1];
  c.solver.array = [opened](int k) { return opened->read_doubles(name_of_array(k)); };
  if (sizes[2] > 0) c.solver.wall_forces = file.read_doubles("/wall_forces");
  if (std::ssize(c.solver.wall_forces) != sizes[2]) throw damaged("lacks its walls' forces");
  return c;
}

}  // namespace flowrest::mpm
