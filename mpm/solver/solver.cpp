#include "mpm/solver/solver.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>

#include "mpm/boundary/nearby_walls.h"
#include "mpm/boundary/plane_friction.h"
#include "mpm/boundary/wall_contact.h"
#include "mpm/material/deviator.h"
#include "mpm/solver/block_shares.h"
#include "mpm/solver/kernels.h"
#include "mpm/solver/particles.h"
#include "mpm/solver/team.h"
#include "mpm/transfer/shape.h"
#include "runs/cores.h"
#include "runs/run_directory.h"

namespace flowrest::mpm {

namespace {

/// Two threads gain over one from about this many particles each.
constexpr std::size_t particles_per_thread = 1500;
constexpr int usual_tile_capacity = 96;

/// Wall time from lap to lap, s.
class Laps {
 public:
  void add_to(double& sum) {
    const auto now = Clock::now();
    sum += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

template <class T>
class SolverOf final : public Solver {
 public:
  SolverOf(const SolverSettings& settings, const SeedSource& seeds) : SolverOf(settings) {
    std::vector<CellIndex> cells;
    seeds([&](const Seed& seed) { cells.push_back(seed.cell); });
    const std::vector<std::uint32_t> places = find_places(std::move(cells));
    auto place = places.begin();
    seeds([&](const Seed& seed) { sow(seed, *place++); });
    begin();
  }

  SolverOf(const SolverSettings& settings, const StoredState& state) : SolverOf(settings) {
    const std::vector<std::uint32_t> places = find_places(state.cells);
    for (int k = 0; k < particles_.array_count(); ++k) {
      const std::vector<double> from = state.array(k);
      for (std::size_t p = 0; p < places.size(); ++p)
        particles_.array(k)[places[p]] = static_cast<T>(from.at(p));
    }
    tile_capacity_ = std::max(state.tile_capacity, usual_tile_capacity);
    if (contact_) contact_->set_forces(state.wall_forces);
    begin();
  }

  void exchange(const std::function<bool(const Vector&)>& leaves,
                const std::function<void(const ParticleBatch&)>& use,
                const std::vector<Seed>& come) override {
    settle();
    const auto arrays = static_cast<std::size_t>(particles_.array_count());
    std::vector<CellIndex> cells;
    std::vector<std::vector<T>> kept(arrays);
    ParticleBatch batch, leaving;
    for (const auto slot : blocks_.occupied()) {
      const BlockView block = blocks_.view(slot);
      const std::vector<CellIndex> of_block = blocks_.cells_of(slot);
      if (leaves) fill(batch, block);
      leaving.clear();
      for (std::size_t i = 0; i < of_block.size(); ++i) {
        if (leaves && leaves({batch.position[0][i], batch.position[1][i], batch.position[2][i]})) {
          leaving.add(batch, i);
          continue;
        }
        cells.push_back(of_block[i]);
        for (std::size_t k = 0; k < arrays; ++k)
          kept[k].push_back(particles_.array(static_cast<int>(k))[block.first + i]);
      }
      if (leaving.count > 0) use(leaving);
    }
    const std::size_t stay = cells.size();
    for (const Seed& seed : come) cells.push_back(seed.cell);
    blocks_ = SparseBlocks(settings_.dimension, settings_.bounds);
    make_walls();
    const std::vector<std::uint32_t> places = find_places(std::move(cells));
    for (std::size_t k = 0; k < arrays; ++k)
      for (std::size_t p = 0; p < stay; ++p) particles_.array(static_cast<int>(k))[places[p]] = kept[k][p];
    for (std::size_t p = 0; p < come.size(); ++p) sow(come[p], places[stay + p]);
    parameters_.step = T(0);  // volumes have taken up the last step's dilatation
    begin();
  }

  StepResult step(double step, const std::array<double, 3>& acceleration) override {
    parameters_.step = static_cast<T>(step);
    if (settings_.thixotropic) parameters_.flow.grown = static_cast<T>(settings_.ageing.grown(time_ + step));
    parameters_.keep = static_cast<T>(share_kept(step));
    for (std::size_t a = 0; a < 3; ++a) parameters_.acceleration[a] = static_cast<T>(acceleration[a]);
    drive_ = step * std::hypot(acceleration[0], acceleration[1], acceleration[2]);
    wall_work_ = 0.0;
    run_stages();
    StepResult result = collect(step);
    result.wall_work = wall_work_;
    time_ += step;
    relocate();
    update_volumes();
    return result;
  }

  void set_apic_relaxation_time(double time) override { apic_relaxation_time_ = time; }
  void set_time(double time) override { time_ = time; }
  Vector nozzle_force() const override {
    Vector force = nozzles_ ? nozzles_->impulse() : Vector{};
    for (double& f : force) f /= static_cast<double>(parameters_.step);
    return force;
  }
  Vector wall_force(std::size_t wall) const override { return contact_ ? contact_->force(wall) : Vector{}; }

  void visit(const std::function<void(const ParticleBatch&)>& use) override {
    settle();
    ParticleBatch batch;
    for (const auto slot : blocks_.occupied()) {
      fill(batch, blocks_.view(slot));
      use(batch);
    }
  }

  void visit_motion(const std::function<void(const ParticleBatch&)>& use) override {
    settle();
    ParticleBatch batch;
    for (const auto slot : blocks_.occupied()) {
      fill_motion(batch, blocks_.view(slot));
      use(batch);
    }
  }

  void visit_cells(const std::function<void(std::span<const CellIndex>)>& use) override {
    for (const auto slot : blocks_.occupied()) use(blocks_.cells_of(slot));
  }

  void visit_array(int array, const std::function<void(std::span<const double>)>& use) override {
    settle();
    const int cells = power(block_edge, settings_.dimension);
    std::vector<double> values;
    for (const auto slot : blocks_.occupied()) {
      const BlockView block = blocks_.view(slot);
      const T* const first = particles_.array(array) + block.first;
      values.assign(first, first + block.start[cells]);
      use(values);
    }
  }

  int array_count() const override { return particles_.array_count(); }
  int tile_capacity() const override { return tile_capacity_; }
  std::vector<double> wall_forces() const override {
    return contact_ ? contact_->forces() : std::vector<double>{};
  }

  std::size_t particle_count() const override { return count_; }
  std::size_t occupied_cells() const override {
    std::size_t cells = 0;
    for (const auto slot : blocks_.occupied()) {
      const BlockView v = const_cast<SparseBlocks&>(blocks_).view(slot);
      const int count = power(block_edge, settings_.dimension);
      for (int c = 0; c < count; ++c) cells += v.start[c + 1] > v.start[c];
    }
    return cells;
  }
  std::size_t bytes() const override {
    return particles_.bytes() + blocks_.bytes() +
           (arenas_.size() + nodes_.size() + averages_.size() + holds_.size()) * sizeof(T);
  }
  int threads() const override { return team_->threads(); }
  const std::string& instruction_set() const override { return instruction_set_; }
  const StageTimes& stage_times() const override { return times_; }

 private:
  explicit SolverOf(const SolverSettings& settings)
      : settings_(settings),
        particles_({settings.dimension, settings.transfer == Transfer::quadratic_apic,
                    settings.transfer == Transfer::linear_flip, settings.thixotropic}),
        blocks_(settings.dimension, settings.bounds),
        instruction_set_(settings.instruction_set.empty() ? instruction_sets().front()
                                                          : settings.instruction_set),
        kernels_(kernels<T>(instruction_set_, settings.dimension, settings.axisymmetric, settings.transfer)) {
    auto& p = parameters_;
    p.cell = static_cast<T>(settings.cell);
    p.density = static_cast<T>(settings.density);
    p.flow = {static_cast<T>(settings.flow.yield_stress),
              static_cast<T>(settings.flow.plastic_viscosity),
              static_cast<T>(settings.flow.regularisation_time),
              static_cast<T>(settings.flow.critical_shear_rate),
              static_cast<T>(settings.structure.growth),
              static_cast<T>(settings.structure.breakdown),
              static_cast<T>(settings.flow.flow_index),
              static_cast<T>(settings.structure.exponent),
              T(0)};
    p.state = {static_cast<T>(settings.state.bulk_modulus), static_cast<T>(settings.state.shear_modulus),
               static_cast<T>(settings.state.exponent)};
    p.law = settings.law;
    p.thixotropic = settings.thixotropic;
    p.stress_rate = settings.stress_rate;
    p.dilatation = settings.b_bar();
    p.explicit_fluid = settings.explicit_fluid;
    p.density_correction = static_cast<T>(settings.density_correction);
    const bool as_published = p.dilatation == Dilatation::centroid;
    p.filling_matters = settings.free_surface && !as_published;
    p.full_cells = !settings.free_surface && !as_published;
    for (std::size_t a = 0; a < 3; ++a) p.bounds[a] = settings.bounds[a];
    // Relative to the mass of a full cell (on the axis' own ring where axisymmetric), small enough to keep
    // every real contribution and large enough that its inverse stays finite.
    const double full =
        settings.density * std::pow(settings.cell, settings.axisymmetric ? 3 : settings.dimension);
    p.smallest_mass = static_cast<T>(full * 1e-25);
    if (!settings.nozzles.empty())
      nozzles_ = std::make_unique<NozzleNodes<T>>(settings.nozzles, settings.cell);
    make_walls();
    if (settings.walls.empty()) return;
    p.walls = this;
    p.keep_out = [](const void* self, WallSet near, double(&place)[3]) {
      return static_cast<const SolverOf*>(self)->keep_out(near, place);
    };
  }

  /// What holds the nodes of walls, which knows where blocks lie; forces at walls' points stay.
  void make_walls() {
    const bool quadratic = settings_.transfer == Transfer::quadratic_apic;
    const typename PlaneFriction<T>::Grid planes{settings_.dimension, quadratic, settings_.bounds};
    if (PlaneFriction<T>::is_needed(planes)) plane_friction_ = std::make_unique<PlaneFriction<T>>(planes);
    if (settings_.walls.empty()) return;
    const std::vector<double> forces = wall_forces();
    contact_ = std::make_unique<WallContact<T>>(
        typename WallContact<T>::Grid{settings_.dimension, quadratic, settings_.cell, settings_.bounds},
        settings_.walls, kernels_.contact);
    if (!forces.empty()) contact_->set_forces(forces);
    nearby_walls_ = std::make_unique<NearbyWalls>(settings_.walls, settings_.dimension, settings_.cell);
  }

  /// Puts a particle to its place.
  void sow(const Seed& seed, std::uint32_t at) {
    const ParticleView<T>& v = particles_.view();
    for (std::size_t a = 0; a < static_cast<std::size_t>(settings_.dimension); ++a) {
      v.position[a][at] = std::clamp(static_cast<T>(seed.position[a]), lowest_in_cell(), highest_in_cell());
      v.velocity[a][at] = static_cast<T>(seed.velocity[a]);
    }
    v.mass[at] = static_cast<T>(seed.volume * settings_.density);
    v.volume_ratio[at] = static_cast<T>(seed.volume_ratio);
    v.pressure[at] = parameters_.state.at(v.volume_ratio[at]).pressure;
    if (v.lambda) v.lambda[at] = static_cast<T>(seed.flocculation);
    for (int c = 0; c < deviator_components(); ++c)
      v.deviator[c][at] = static_cast<T>(seed.deviator[static_cast<std::size_t>(c)]);
    v.rate[at] = static_cast<T>(seed.rate);
  }

  /// Room for particles in these cells. Returns their places.
  std::vector<std::uint32_t> find_places(std::vector<CellIndex> cells) {
    count_ = cells.size();
    std::vector<std::uint32_t> places = blocks_.build(cells);
    cells = {};
    particles_.make_room(blocks_.room());
    return places;
  }

  /// With all particles in their places.
  void begin() {
    prepare();
    fit_workspaces();
    update_volumes();
  }

  /// Share of their own velocity that particles keep over a step. APIC: the rest, and so the smoothing of the
  /// transfer, grows in proportion to the step and is whole from one relaxation time on.
  double share_kept(double step) const {
    if (settings_.transfer == Transfer::quadratic_apic)
      return std::max(0.0, 1.0 - step / std::max(apic_relaxation_time_, step));
    return std::exp(-step / settings_.flip_relaxation_time);
  }

  /// Out of the walls as they are at the step's end.
  bool keep_out(WallSet near, double (&place)[3]) const {
    constexpr double farthest = 0.5;  // cells
    Vector x = {place[0], place[1], place[2]};
    const double end = time_ + static_cast<double>(parameters_.step);
    if (!nearby_walls_->hold(near, x, end)) return false;
    if (!push_out(settings_.walls, settings_.dimension, end, farthest * settings_.cell, x)) return false;
    std::copy(x.begin(), x.end(), place);
    return true;
  }

  void mark_walls_nearby() {
    for (BlockView& view : views_) view.walls = nearby_walls_->of_block(view.slot, view.origin);
  }

  /// Bounds of a place within a cell, for particles that are put there.
  T margin() const {
    return static_cast<T>(settings_.transfer == Transfer::linear_flip ? Linear::margin : Quadratic::margin);
  }
  T lowest_in_cell() const { return margin(); }
  T highest_in_cell() const {
    return std::min(T(1) - margin(), sizeof(T) == 8 ? T(1 - 0x1p-53) : T(1 - 0x1p-24f));
  }

  void prepare() {
    const auto values = static_cast<std::size_t>(node_values);
    const auto arena_size = static_cast<std::size_t>(power(arena_edge, settings_.dimension)) * values;
    const auto nodes_size = static_cast<std::size_t>(power(block_edge, settings_.dimension)) * values;
    const std::size_t slots = blocks_.slot_count();
    const std::size_t occupied = blocks_.occupied().size();
    const auto with_spare = [](std::size_t count) { return count + count / 16; };
    const auto make_room = [&](AlignedArray<T>& array, std::size_t records, std::size_t size) {
      if (array.size() >= records * size) return;
      array = {};  // before there is another
      array = AlignedArray<T>(with_spare(records) * size);
    };
    make_room(arenas_, occupied, arena_size);
    make_room(nodes_, slots, nodes_size);
    if (smooth()) {
      // Blocks keep their slots, and the last step's dilatation is still to be taken up.
      const std::size_t size =
          static_cast<std::size_t>(power(block_edge, settings_.dimension) * average_count);
      if (averages_.size() < slots * size) {
        AlignedArray<T> more(with_spare(slots) * size);
        std::copy_n(averages_.data(), averages_.size(), more.data());
        averages_ = std::move(more);
      }
    }
    if (plane_friction_) {
      const std::size_t size = slots * static_cast<std::size_t>(power(block_edge, settings_.dimension));
      if (holds_.size() < size) holds_ = AlignedArray<T>(with_spare(size));
    }
    views_.clear();
    for (const auto slot : blocks_.occupied()) views_.push_back(blocks_.view(slot));
    fit_team();
    share_out();
    if (contact_) mark_walls_nearby();
  }

  /// As many threads as the particles can feed now, unless the scene names a number.
  void fit_team() {
    const int fed = std::clamp(static_cast<int>(count_ / particles_per_thread), 1, cores_);
    const int threads = settings_.threads > 0 ? settings_.threads : fed;
    if (team_ && team_->threads() == threads) return;
    team_ = std::make_unique<Team>(threads);
    shares_ = BlockShares(threads);
    node_shares_ = BlockShares(threads);
    tables_.resize(static_cast<std::size_t>(threads));
  }

  /// Room for the fullest cell.
  void fit_workspaces() {
    while (static_cast<std::size_t>(tile_capacity_ - tile_padding) < blocks_.fullest_cell())
      tile_capacity_ += 32;
    const auto threads = static_cast<std::size_t>(team_->threads());
    if (workspaces_.size() != threads || workspaces_.front().capacity != tile_capacity_) {
      workspaces_.clear();
      workspace_memory_.clear();
      for (std::size_t t = 0; t < threads; ++t) {
        workspace_memory_.emplace_back(static_cast<std::size_t>(workspace_arrays) *
                                       static_cast<std::size_t>(tile_capacity_));
        workspaces_.push_back({workspace_memory_.back().data(), tile_capacity_});
      }
    }
  }

  /// Every thread gets as many particles, in blocks that lie side by side, and the nodes among them.
  void share_out() {
    const auto cells = static_cast<std::size_t>(power(block_edge, settings_.dimension));
    const auto threads = static_cast<std::size_t>(team_->threads());
    std::vector<std::uint32_t> ends;
    std::size_t before = 0;
    for (std::uint32_t b = 0; b < views_.size(); ++b) {
      while (before * threads > count_ * (ends.size() + 1)) ends.push_back(b);
      before += views_[b].start[cells];
    }
    ends.resize(threads, static_cast<std::uint32_t>(views_.size()));
    shares_.share_out(std::move(ends));

    std::vector<std::vector<NodeView>> of_thread(threads);
    for (std::uint32_t slot = 0; slot < blocks_.slot_count(); ++slot) {
      const NodeView nodes = blocks_.node_view(slot);
      // Nodes of no block are in one whose material has left; they are nobody's.
      const auto* const end = nodes.minus + (1 << settings_.dimension);
      const auto* const arena = std::find_if(nodes.minus, end, [](std::uint32_t a) { return a != no_slot; });
      of_thread[arena == end ? 0 : static_cast<std::size_t>(shares_.owner(*arena))].push_back(nodes);
    }
    node_views_.clear();
    std::vector<std::uint32_t> node_ends;
    for (const auto& own : of_thread) {
      node_views_.insert(node_views_.end(), own.begin(), own.end());
      node_ends.push_back(static_cast<std::uint32_t>(node_views_.size()));
    }
    node_shares_.share_out(std::move(node_ends));
  }

  void run_stages() {
    if (contact_) {
      if (nearby_walls_->follow(time_ + static_cast<double>(parameters_.step))) mark_walls_nearby();
      contact_->place(blocks_, time_);
    }
    if (plane_friction_) plane_friction_->place(blocks_);
    const Grid<T> grid{arenas_.data(), nodes_.data(), averages_.data(), holds_.data()};
    Laps laps;
    // A block's particles are put in order when they are needed next, for then they are in the cache anyway.
    over_blocks([&](BlockView& block, std::size_t thread) {
      settle(block, tables_[thread]);
      kernels_.particles_to_grid(parameters_, particles_.view(), block, grid, workspaces_[thread]);
    });
    laps.add_to(times_.particles_to_grid);
    over_nodes(kernels_.update_nodes, grid);
    hold_walls(grid);
    laps.add_to(times_.nodes);
    over_blocks([&](BlockView& block, std::size_t thread) {
      *block.sums = {};
      kernels_.grid_to_particles(parameters_, particles_.view(), block, grid, workspaces_[thread]);
      if (!kernels_.remapped_to_particles) blocks_.plan_movers(block.slot);
    });
    laps.add_to(times_.grid_to_particles);
    if (smooth()) over_nodes(kernels_.average_dilatation, grid);
    if (!kernels_.remapped_to_particles) {
      laps.add_to(times_.nodes);
      return;
    }
    over_nodes(kernels_.remap_nodes, grid);
    hold_walls_remapped(grid);
    laps.add_to(times_.nodes);
    over_blocks([&](BlockView& block, std::size_t thread) {
      kernels_.remapped_to_particles(parameters_, particles_.view(), block, grid, workspaces_[thread]);
      blocks_.plan_movers(block.slot);
    });
    laps.add_to(times_.grid_to_particles);
  }

  /// Runs `stage(block, thread)` over all blocks, each on the thread that it is shared out to if that one has
  /// time.
  template <class Stage>
  void over_blocks(const Stage& stage) {
    team_->run(shares_,
               [&](std::uint32_t b, int thread) { stage(views_[b], static_cast<std::size_t>(thread)); });
  }
  void over_nodes(NodeStage<T> stage, const Grid<T>& grid) {
    team_->run(node_shares_, [&](std::uint32_t b, int) { stage(parameters_, node_views_[b], grid); });
  }

  /// Holds the nodes to every wall that the arenas do not hold themselves. Planes of friction are asked again
  /// after walls of any shape, which lean on what the planes hold.
  void hold_walls(const Grid<T>& grid) {
    if (nozzles_)
      wall_work_ += nozzles_->hold(blocks_, time_, static_cast<double>(parameters_.step), grid.nodes);
    if (plane_friction_) plane_friction_->hold(grid.nodes);
    if (contact_) wall_work_ += contact_->apply(grid.nodes, static_cast<double>(parameters_.step), drive_);
    if (plane_friction_ && contact_) plane_friction_->hold_again(grid.nodes);
    if (plane_friction_) wall_work_ += plane_friction_->finish(grid.nodes, grid.holds);
  }
  void hold_walls_remapped(const Grid<T>& grid) {
    if (plane_friction_) plane_friction_->hold_remapped(grid.nodes);
    if (contact_) contact_->apply_to_remapped(grid.nodes, drive_);
  }

  bool smooth() const { return parameters_.dilatation == Dilatation::smooth; }

  /// Volumes and pressures by the dilatation that the nodes have averaged, with every particle in its new
  /// cell, and the pressure that acts in the next step. With a step of no length, that pressure alone.
  void update_volumes() {
    if (!smooth()) return;
    Laps laps;
    const Grid<T> grid{arenas_.data(), nodes_.data(), averages_.data()};
    over_blocks([&](BlockView& block, std::size_t thread) {
      settle(block, tables_[thread]);
      kernels_.update_volumes(parameters_, particles_.view(), block, grid, workspaces_[thread]);
    });
    over_nodes(kernels_.average_pressure, grid);
    laps.add_to(times_.volumes);
  }

  StepResult collect(double step) {
    StepResult result;
    double speed_squared = 0.0;
    std::uint32_t faults = 0;
    moved_ = false;
    for (const auto& view : views_) {
      const BlockSums& s = *view.sums;
      speed_squared = std::max(speed_squared, s.largest_speed_squared);
      result.largest_pressure = std::max(result.largest_pressure, s.largest_pressure);
      result.dissipated += s.dissipated;
      result.momentum += s.momentum;
      faults += s.faults;
      moved_ |= s.movers > 0;
    }
    result.largest_speed = std::sqrt(speed_squared);
    require_stable(faults, result.dissipated, step);
    return result;
  }

  void relocate() {
    Laps laps;
    if (moved_) {
      const auto& plan = blocks_.relocate(shares_, *team_);
      for (const auto& h : plan.held)
        particles_.view().position[h.axis][h.place] = h.upper ? highest_in_cell() : lowest_in_cell();
      particles_.make_way(blocks_, plan, *team_);
      if (plan.other_blocks) prepare();
      fit_workspaces();
    }
    laps.add_to(times_.sorting);
  }

  /// One block's particles, where the last relocation has them, for a thread with a `table` of its own.
  void settle(BlockView& block, std::vector<T>& table) {
    blocks_.follow(block);
    particles_.settle(blocks_.reordering(block.slot), table);
  }

  /// Everything in its place, for those who look at particles between steps.
  void settle() {
    for (const auto slot : blocks_.occupied()) particles_.settle(blocks_.reordering(slot), tables_.front());
  }

  void fill_motion(ParticleBatch& batch, const BlockView& block) {
    const ParticleView<T>& v = particles_.view();
    const int dim = settings_.dimension, cells = power(block_edge, dim);
    batch.count = block.start[cells];
    for (auto& a : batch.position) a.assign(batch.count, 0.0);
    for (auto& a : batch.velocity) a.assign(batch.count, 0.0);
    batch.mass.resize(batch.count);
    for (int cell = 0; cell < cells; ++cell) {
      const int in_block[3] = {dim == 3 ? cell / 16 : cell / 4, dim == 3 ? cell / 4 % 4 : cell % 4, cell % 4};
      for (std::size_t i = block.start[cell]; i < block.start[cell + 1]; ++i) {
        const std::size_t p = block.first + i;
        for (int a = 0; a < dim; ++a) {
          const auto axis = static_cast<std::size_t>(a);
          batch.position[axis][i] =
              (block.origin[a] + in_block[a] + static_cast<double>(v.position[a][p])) * settings_.cell;
          batch.velocity[axis][i] = static_cast<double>(v.velocity[a][p]);
        }
        batch.mass[i] = static_cast<double>(v.mass[p]);
      }
    }
  }

  void fill(ParticleBatch& batch, const BlockView& block) {
    fill_motion(batch, block);
    const ParticleView<T>& v = particles_.view();
    const std::size_t count = batch.count;
    const EquationOfState<double> state{settings_.state.bulk_modulus, settings_.state.shear_modulus,
                                        settings_.state.exponent};
    for (auto* a :
         {&batch.volume, &batch.rate, &batch.shear_stress, &batch.raw_pressure, &batch.elastic_energy})
      a->resize(count);
    batch.flocculation.resize(v.lambda ? count : 0);
    for (int c = 0; c < deviator_components(); ++c) {
      const T* const from = v.deviator[c] + block.first;
      batch.deviator[static_cast<std::size_t>(c)].assign(from, from + count);
    }
    if (smooth()) {
      std::vector<T> pressure(count);
      kernels_.acting_pressure(parameters_, v, block, {nullptr, nullptr, averages_.data()},
                               workspaces_.front(), pressure.data());
      batch.acting_pressure.assign(pressure.begin(), pressure.end());
    }
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t p = block.first + i;
      const double ratio = static_cast<double>(v.volume_ratio[p]);
      batch.volume[i] = batch.mass[i] / settings_.density * ratio;
      batch.rate[i] = static_cast<double>(v.rate[p]);
      batch.shear_stress[i] = shear_stress(p);
      batch.raw_pressure[i] = static_cast<double>(v.pressure[p]);
      if (v.lambda) batch.flocculation[i] = static_cast<double>(v.lambda[p]);
      const double shape = settings_.explicit_fluid ? 0.0
                                                    : batch.shear_stress[i] * batch.shear_stress[i] /
                                                          (2.0 * state.at(ratio).shear) * ratio;
      batch.elastic_energy[i] = batch.mass[i] / settings_.density * (shape + state.energy(ratio));
    }
  }

  int deviator_components() const { return settings_.dimension == 2 ? 3 : 5; }

  double shear_stress(std::size_t p) const {
    const ParticleView<T>& v = particles_.view();
    const auto d = [&](int c) { return static_cast<double>(v.deviator[c][p]); };
    if (settings_.dimension == 2) return std::sqrt(Deviator<double, 2>{d(0), d(1), d(2)}.half_square());
    return std::sqrt(Deviator<double, 3>{d(0), d(1), d(2), d(3), d(4)}.half_square());
  }

  SolverSettings settings_;
  std::size_t count_ = 0;
  Particles<T> particles_;
  SparseBlocks blocks_;
  std::string instruction_set_;
  Kernels<T> kernels_;
  StepParameters<T> parameters_;
  double apic_relaxation_time_ = 0.0;
  std::unique_ptr<NozzleNodes<T>> nozzles_;    ///< null where the settings have none
  std::unique_ptr<WallContact<T>> contact_;    ///< null where no wall but planes along the grid is given
  std::unique_ptr<NearbyWalls> nearby_walls_;  ///< likewise
  std::unique_ptr<PlaneFriction<T>> plane_friction_;  ///< null where no plane along the grid has friction
  double time_ = 0.0;                                 ///< s
  double drive_ = 0.0;                                ///< m/s that the driving force gives in a step
  double wall_work_ = 0.0;                            ///< J in this step
  int cores_ = runs::cores();
  std::unique_ptr<Team> team_;
  int tile_capacity_ = usual_tile_capacity;
  AlignedArray<T> arenas_, nodes_, averages_, holds_;
  std::vector<AlignedArray<T>> workspace_memory_;
  std::vector<Workspace<T>> workspaces_;
  std::vector<BlockView> views_;
  std::vector<NodeView> node_views_;
  BlockShares shares_, node_shares_;    ///< of views_, and of node_views_
  std::vector<std::vector<T>> tables_;  ///< of each thread, to put a block in order on
  bool moved_ = false;
  StageTimes times_;
};

}  // namespace

void require_stable(std::uint32_t faults, double dissipated, double step) {
  if (faults > 0 || !std::isfinite(dissipated))
    throw runs::NumericsError(
        fmt::format("{} particles moved further than one cell in one step of {:.3g} s, or are no longer "
                    "finite: the step is unstable",
                    faults, step));
}

namespace {

/// Every array of a batch.
template <class Batch>
auto arrays_of(Batch& b) {
  return std::array{&b.position[0],  &b.position[1],    &b.position[2],  &b.velocity[0],
                    &b.velocity[1],  &b.velocity[2],    &b.mass,         &b.volume,
                    &b.rate,         &b.shear_stress,   &b.raw_pressure, &b.acting_pressure,
                    &b.flocculation, &b.elastic_energy, &b.deviator[0],  &b.deviator[1],
                    &b.deviator[2],  &b.deviator[3],    &b.deviator[4]};
}

}  // namespace

void ParticleBatch::clear() {
  count = 0;
  for (auto* array : arrays_of(*this)) array->clear();
}

void ParticleBatch::add(const ParticleBatch& other, std::size_t particle) {
  ++count;
  const auto to = arrays_of(*this);
  const auto from = arrays_of(other);
  for (std::size_t k = 0; k < to.size(); ++k)
    if (!from[k]->empty()) to[k]->push_back((*from[k])[particle]);
}

SolverState Solver::state() {
  SolverState out;
  visit_cells([&](std::span<const CellIndex> c) { out.cells.insert(out.cells.end(), c.begin(), c.end()); });
  for (int k = 0; k < array_count(); ++k) {
    auto& to = out.arrays.emplace_back();
    visit_array(k, [&](std::span<const double> v) { to.insert(to.end(), v.begin(), v.end()); });
  }
  out.tile_capacity = tile_capacity();
  out.wall_forces = wall_forces();
  return out;
}

SeedSource source_of(const std::vector<Seed>& seeds) {
  return [&seeds](const std::function<void(const Seed&)>& use) {
    for (const Seed& seed : seeds) use(seed);
  };
}

StoredState stored(const SolverState& state) {
  return {state.cells, [&state](int k) { return state.arrays.at(static_cast<std::size_t>(k)); },
          static_cast<int>(state.arrays.size()), state.tile_capacity, state.wall_forces};
}

std::unique_ptr<Solver> make_solver(const SolverSettings& settings, const SeedSource& seeds) {
  if (settings.single_precision) return std::make_unique<SolverOf<float>>(settings, seeds);
  return std::make_unique<SolverOf<double>>(settings, seeds);
}

std::unique_ptr<Solver> make_solver(const SolverSettings& settings, const StoredState& state) {
  if (settings.single_precision) return std::make_unique<SolverOf<float>>(settings, state);
  return std::make_unique<SolverOf<double>>(settings, state);
}

std::unique_ptr<Solver> make_solver(const SolverSettings& settings, const std::vector<Seed>& seeds) {
  return make_solver(settings, source_of(seeds));
}

std::unique_ptr<Solver> make_solver(const SolverSettings& settings, const SolverState& state) {
  return make_solver(settings, stored(state));
}

}  // namespace flowrest::mpm
