// No include guard: included once by each of the kernels_*.cpp, inside a namespace of its own (FLOWREST_KERNEL_SPACE),
// compiled for that instruction set. Nothing here may use library templates, whose instances a linker would merge
// across instruction sets.

namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

/// Four values of one node record.
template <class T>
struct RecordOf;
template <>
struct RecordOf<float> {
  typedef float type __attribute__((vector_size(16), aligned(4), may_alias));
};
template <>
struct RecordOf<double> {
  typedef double type __attribute__((vector_size(32), aligned(8), may_alias));
};
template <class T>
using Record = typename RecordOf<T>::type;

/// As many particles as one register of this instruction set holds.
template <class T>
struct LanesOf;
template <>
struct LanesOf<float> {
  typedef float type __attribute__((vector_size(FLOWREST_LANE_BYTES), aligned(4), may_alias));
};
template <>
struct LanesOf<double> {
  typedef double type __attribute__((vector_size(FLOWREST_LANE_BYTES), aligned(8), may_alias));
};
template <class T>
using Lanes = typename LanesOf<T>::type;

template <class T>
FLOWREST_INLINE Record<T>& record_at(T* p) {
  return *reinterpret_cast<Record<T>*>(p);
}
template <class T>
FLOWREST_INLINE const Record<T>& record_at(const T* p) {
  return *reinterpret_cast<const Record<T>*>(p);
}
template <class T>
FLOWREST_INLINE Lanes<T>& lanes_at(T* p) {
  return *reinterpret_cast<Lanes<T>*>(p);
}
template <class T>
FLOWREST_INLINE const Lanes<T>& lanes_at(const T* p) {
  return *reinterpret_cast<const Lanes<T>*>(p);
}

template <int Dim>
FLOWREST_INLINE constexpr int arena_index(int i, int j, int k) {
  return Dim == 3 ? (i * arena_edge + j) * arena_edge + k : i * arena_edge + k;
}

/// A run of whole cells whose particles are handled together, as structures of arrays in the workspace.
template <class T, int Dim>
struct Tile {
  const BlockView& block;
  T* memory;
  int capacity;
  int used = 0;
  int first_cell = 0, last_cell = 0;  ///< [first, last) of the block
  int first = 0, count = 0;           ///< in the block's list

  Tile(const BlockView& b, const Workspace<T>& w) : block(b), memory(w.memory), capacity(w.capacity) {}

  /// Takes the next cells, as many as fit; false when none are left.
  bool next() {
    constexpr int cells = cells_per_block<Dim>;
    first_cell = last_cell;
    while (first_cell < cells && block.start[first_cell + 1] == block.start[first_cell]) ++first_cell;
    if (first_cell == cells) return false;
    first = static_cast<int>(block.start[first_cell]);
    last_cell = first_cell + 1;
    while (last_cell < cells && static_cast<int>(block.start[last_cell + 1]) - first <= capacity - tile_padding) ++last_cell;
    count = static_cast<int>(block.start[last_cell]) - first;
    used = 0;
    return true;
  }
  T* fresh() { return memory + capacity * used++; }
  int cell_first(int cell) const { return static_cast<int>(block.start[cell]) - first; }
  int cell_count(int cell) const { return static_cast<int>(block.start[cell + 1] - block.start[cell]); }

  /// The tile's values of a particle array: in place where the list is contiguous, else copied.
  T* open(T* array) {
    const std::uint32_t* list = block.list + first;
    if (block.contiguous) return array + list[0];
    T* copy = fresh();
    for (int q = 0; q < count; ++q) copy[q] = array[list[q]];
    return copy;
  }
  void close(T* array, const T* values) {
    if (block.contiguous && values == array + block.list[first]) return;
    const std::uint32_t* list = block.list + first;
    if (block.contiguous) {
      T* to = array + list[0];
      for (int q = 0; q < count; ++q) to[q] = values[q];
    } else {
      for (int q = 0; q < count; ++q) array[list[q]] = values[q];
    }
  }
};

/// Weights, slopes and (APIC) weighted offsets of a tile's particles, per axis and node.
template <class T, int Dim, class Shape>
struct Weights {
  T* weight[Dim][Shape::nodes];
  T* slope[Dim][Shape::nodes];

  void make(Tile<T, Dim>& tile, const T* const* position) {
    for (int a = 0; a < Dim; ++a) {
      for (int n = 0; n < Shape::nodes; ++n) weight[a][n] = tile.fresh();
      for (int n = 0; n < Shape::nodes; ++n) slope[a][n] = tile.fresh();
      const T* x = position[a];
#pragma omp simd
      for (int q = 0; q < tile.count; ++q) {
        for (int n = 0; n < Shape::nodes; ++n) {
          weight[a][n][q] = Shape::weight(n, x[q]);
          slope[a][n][q] = Shape::slope(n, x[q]);
        }
      }
    }
  }
};

template <class T, int Dim>
FLOWREST_INLINE void cell_coordinates(int cell, int (&c)[3]) {
  if constexpr (Dim == 3) {
    c[0] = cell / 16;
    c[1] = cell / 4 % 4;
    c[2] = cell % 4;
  } else {
    c[0] = cell / 4;
    c[1] = 0;
    c[2] = cell % 4;
  }
}

/// Arena node of a cell's first stencil node.
template <class T, int Dim>
FLOWREST_INLINE int cell_base(int cell) {
  int c[3];
  cell_coordinates<T, Dim>(cell, c);
  return arena_index<Dim>(c[0], c[1], c[2]);
}

// ---------------------------------------------------------------------------------------------------------------------
// Particles to grid

/// One particle's contribution to the node records around it, the product of the axes' weights times
/// value + sum over the axes of term / weight: `term[a][n]` holds what axis a's node n brings beyond the plain weight (its
/// offset times the affine part, its slope times the stress).
template <class T, int Dim, class Shape, bool Terms>
struct Source {
  T value[4];
  T term[Terms ? Dim : 1][Terms ? Shape::nodes : 1][4];
};

/// Adds the particles [first, first + count) of a tile, all of one cell, to that cell's nodes. The accumulators of a slab
/// of nodes stay in registers over the particles.
template <class T, int Dim, class Shape, bool Terms>
void scatter(T* arena_cell, int node_stride, const Source<T, Dim, Shape, Terms>* source, const Weights<T, Dim, Shape>& w,
             int first, int count) {
  constexpr int nodes = Shape::nodes;
  constexpr int rows = Dim == 3 ? nodes : 1;
  constexpr int last = Dim - 1;
  const Record<T> zero = {};
  for (int i = 0; i < nodes; ++i) {
    Record<T> sum[rows][nodes];
#pragma GCC unroll 9
    for (int j = 0; j < rows; ++j)
#pragma GCC unroll 9
      for (int k = 0; k < nodes; ++k) sum[j][k] = zero;
    for (int q = first; q < first + count; ++q) {
      const auto& s = source[q];
      const T wi = w.weight[0][i][q];
#pragma GCC unroll 9
      for (int j = 0; j < rows; ++j) {
        T wij = wi;
        Record<T> plane;
        if constexpr (Dim == 3) {
          const T wj = w.weight[1][j][q];
          wij = wi * wj;
          plane = wij * record_at(s.value);
          if constexpr (Terms) plane += wj * record_at(s.term[0][i]) + wi * record_at(s.term[1][j]);
        } else {
          plane = wij * record_at(s.value);
          if constexpr (Terms) plane += record_at(s.term[0][i]);
        }
#pragma GCC unroll 9
        for (int k = 0; k < nodes; ++k) {
          sum[j][k] += w.weight[last][k][q] * plane;
          if constexpr (Terms) sum[j][k] += wij * record_at(s.term[last][k]);
        }
      }
    }
#pragma GCC unroll 9
    for (int j = 0; j < rows; ++j)
#pragma GCC unroll 9
      for (int k = 0; k < nodes; ++k)
        record_at(arena_cell + arena_index<Dim>(i, j, k) * node_stride) += sum[j][k];
  }
}

/// Folds what fell on the ghost nodes behind plane walls onto their mirror images: mass is added, momentum with the sign of
/// the mirrored body's. Only the quadratic functions reach behind a wall.
template <class T, int Dim>
void fold_ghosts(T* arena, int records, const BlockView& block, const AxisBounds* bounds) {
  const int edge[3] = {arena_edge, Dim == 3 ? arena_edge : 1, arena_edge};
  for (int a = 0; a < Dim; ++a) {
    const int axis = Dim == 2 && a == 1 ? 2 : a;
    for (int side = 0; side < 2; ++side) {
      const PlaneWall wall = side == 0 ? bounds[a].lower : bounds[a].upper;
      const int cell = (side == 0 ? bounds[a].lower_cell : bounds[a].upper_cell - 1) - block.origin[a];
      if (wall == PlaneWall::none || cell < 0 || cell >= block_edge) continue;
      const int ghost = side == 0 ? cell : cell + 2, image = cell + 1;
      int n[3];
      for (n[0] = 0; n[0] < edge[0]; ++n[0])
        for (n[1] = 0; n[1] < edge[1]; ++n[1])
          for (n[2] = 0; n[2] < edge[2]; ++n[2]) {
            if (n[axis] != ghost) continue;
            int m[3] = {n[0], n[1], n[2]};
            m[axis] = image;
            T* from = arena + arena_index<Dim>(n[0], n[1], n[2]) * records * record;
            T* to = arena + arena_index<Dim>(m[0], m[1], m[2]) * records * record;
            for (int r = 0; r < records; ++r) {
              to[r * record] += from[r * record];
              for (int c = 0; c < Dim; ++c) {
                const bool odd = wall == PlaneWall::no_slip || c == a;
                to[r * record + 1 + c] += odd ? -from[r * record + 1 + c] : from[r * record + 1 + c];
              }
              for (int c = 0; c < record; ++c) from[r * record + c] = T(0);
            }
          }
    }
  }
}

/// Pressure to deposit with each particle of a cell: the volume-weighted average over the cell, the adjoint of the averaged
/// divergence (B-bar by cell average).
template <class T, int Dim>
void average_over_cells(const Tile<T, Dim>& tile, const T* volume, T* value) {
  for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
    const int first = tile.cell_first(cell), count = tile.cell_count(cell);
    if (count < 2) continue;
    T sum = T(0), total = T(0);
    for (int q = first; q < first + count; ++q) {
      sum += volume[q] * value[q];
      total += volume[q];
    }
    const T mean = sum / total;
    for (int q = first; q < first + count; ++q) value[q] = mean;
  }
}

/// Global index of each particle's cell along the radius, as a number.
template <class T, int Dim>
void radial_cells(const Tile<T, Dim>& tile, T* out) {
  for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
    int c[3];
    cell_coordinates<T, Dim>(cell, c);
    const int first = tile.cell_first(cell), count = tile.cell_count(cell);
    for (int q = first; q < first + count; ++q) out[q] = static_cast<T>(tile.block.origin[0] + c[0]);
  }
}

template <class T, int Dim, bool Axisymmetric, class Shape, bool Flip>
void particles_to_grid(const StepParameters<T>& step, const ParticleView<T>& particles, const BlockView& block, T* arenas,
                       const T* /*nodes*/, const Workspace<T>& workspace) {
  constexpr int records = Flip ? 2 : 1;
  constexpr int arena_values = nodes_per_arena<Dim> * records * record;
  using Momentum = Source<T, Dim, Shape, !Flip>;  // FLIP: (m, m v) alone
  using Force = Source<T, Dim, Shape, true>;
  T* arena = arenas + static_cast<std::size_t>(block.slot) * arena_values;
  for (int i = 0; i < arena_values; ++i) arena[i] = T(0);

  Tile<T, Dim> tile(block, workspace);
  while (tile.next()) {
    const int count = tile.count;
    T* x[Dim];
    for (int a = 0; a < Dim; ++a) x[a] = tile.open(particles.position[a]);
    const T* mass = tile.open(particles.mass);
    const T* ratio = tile.open(particles.volume_ratio);
    const T* raw_pressure = tile.open(particles.pressure);
    Weights<T, Dim, Shape> weights;
    weights.make(tile, x);

    T* volume = tile.fresh();
    T* pressure = tile.fresh();
    const T per_density = T(1) / step.density;
#pragma omp simd
    for (int q = 0; q < count; ++q) {
      volume[q] = mass[q] * ratio[q] * per_density;
      pressure[q] = raw_pressure[q];
    }
    const bool centroid = step.dilatation == Dilatation::centroid;
    if (!centroid) average_over_cells(tile, volume, pressure);

    T* per_radius = nullptr;
    T* radial = nullptr;
    if constexpr (Axisymmetric) {
      radial = tile.fresh();
      per_radius = tile.fresh();
      radial_cells(tile, radial);
#pragma omp simd
      for (int q = 0; q < count; ++q) per_radius[q] = T(1) / (step.cell * maximum(radial[q] + x[0][q], T(1e-6)));
    }

    // Sources are an array of structures: each is read whole, broadcast over a cell's nodes. They take the workspace's
    // rest, and what only they need is read from the particles' arrays straight away.
    constexpr int source_values = static_cast<int>((sizeof(Momentum) + (Flip ? sizeof(Force) : 0)) / sizeof(T));
    T* source_memory = tile.memory + tile.capacity * tile.used;
    Momentum* momentum = reinterpret_cast<Momentum*>(source_memory);
    Force* force = reinterpret_cast<Force*>(source_memory + static_cast<int>(sizeof(Momentum) / sizeof(T)) * tile.capacity);
    static_assert(source_values + 30 <= workspace_arrays);
    const T dt = step.step, impulse_per_cell = dt / step.cell;
    const std::uint32_t* list = block.list + tile.first;
    for (int q = 0; q < count; ++q) {
      const std::uint32_t id = list[q];
      Deviator<T, Dim> dev;
      if constexpr (Dim == 2) {
        dev = {particles.deviator[0][id], particles.deviator[1][id], particles.deviator[2][id]};
      } else {
        dev = {particles.deviator[0][id], particles.deviator[1][id], particles.deviator[2][id], particles.deviator[3][id],
               particles.deviator[4][id]};
      }
      const T p = centroid ? T(0) : pressure[q];
      const T m = mass[q], scale = -volume[q] * impulse_per_cell;
      const Record<T> push = {T(0), m * dt * step.acceleration[0], m * dt * step.acceleration[1],
                              Dim == 3 ? m * dt * step.acceleration[2] : T(0)};
      Record<T> moving = {m, m * particles.velocity[0][id], m * particles.velocity[1][id],
                          Dim == 3 ? m * particles.velocity[Dim - 1][id] : T(0)};
      Record<T> forcing = push;
      if constexpr (Axisymmetric) forcing[1] -= volume[q] * dt * (dev.zz() - p) * per_radius[q];
      Record<T> stress[Dim];
      if constexpr (Dim == 3) {
        stress[0] = Record<T>{T(0), scale * (dev.xx - p), scale * dev.xy, scale * dev.xz};
        stress[1] = Record<T>{T(0), scale * dev.xy, scale * (dev.yy - p), scale * dev.yz};
        stress[2] = Record<T>{T(0), scale * dev.xz, scale * dev.yz, scale * (dev.zz() - p)};
      } else {
        stress[0] = Record<T>{T(0), scale * (dev.xx - p), scale * dev.xy, T(0)};
        stress[1] = Record<T>{T(0), scale * dev.xy, scale * (dev.yy - p), T(0)};
      }
      if constexpr (Flip) {
        record_at(momentum[q].value) = moving;
        record_at(force[q].value) = forcing;
        for (int a = 0; a < Dim; ++a)
          for (int n = 0; n < Shape::nodes; ++n) record_at(force[q].term[a][n]) = weights.slope[a][n][q] * stress[a];
      } else {
        record_at(momentum[q].value) = moving + forcing;
        for (int a = 0; a < Dim; ++a) {
          const Record<T> affine = {T(0), m * particles.affine[a][id], m * particles.affine[Dim + a][id],
                                    Dim == 3 ? m * particles.affine[(Dim - 1) * Dim + a][id] : T(0)};
          for (int n = 0; n < Shape::nodes; ++n)
            record_at(momentum[q].term[a][n]) =
                (weights.weight[a][n][q] * Shape::offset(n, x[a][q])) * affine + weights.slope[a][n][q] * stress[a];
        }
      }
    }

    for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
      const int n = tile.cell_count(cell);
      if (n == 0) continue;
      const int first = tile.cell_first(cell);
      T* base = arena + cell_base<T, Dim>(cell) * records * record;
      scatter<T, Dim, Shape, !Flip>(base, records * record, momentum, weights, first, n);
      if constexpr (Flip) scatter<T, Dim, Shape, true>(base + record, records * record, force, weights, first, n);
      if (centroid) {
        // B-bar at the centroid: the pressure's work is done by the divergence at the cell's centre alone.
        T thrust = T(0);
        for (int q = first; q < first + n; ++q) thrust += volume[q] * pressure[q];
        const T hoop = Axisymmetric ? thrust * dt / (step.cell * (radial[first] + T(0.5))) : T(0);
        const T push = thrust * impulse_per_cell;
        for (int i = 0; i < Shape::nodes; ++i)
          for (int j = 0; j < (Dim == 3 ? Shape::nodes : 1); ++j)
            for (int k = 0; k < Shape::nodes; ++k) {
              const T half = T(0.5);
              const T wi = Shape::weight(i, half), wj = Dim == 3 ? Shape::weight(j, half) : T(1), wk = Shape::weight(k, half);
              T* to = base + arena_index<Dim>(i, j, k) * records * record + (Flip ? record : 0) + 1;
              to[0] += push * Shape::slope(i, half) * wj * wk + hoop * wi * wj * wk;
              if constexpr (Dim == 3) to[1] += push * wi * Shape::slope(j, half) * wk;
              to[Dim - 1] += push * wi * wj * Shape::slope(k, half);
            }
      }
    }
  }
  if constexpr (Shape::nodes == 3) fold_ghosts<T, Dim>(arena, records, block, step.bounds);
}

// ---------------------------------------------------------------------------------------------------------------------
// Nodes

/// Sums the arenas that share a block of nodes, in a fixed order, and turns momentum into velocity. Records after it:
/// APIC (mass, velocity); FLIP (mass, new velocity), (0, old velocity).
template <class T, int Dim, bool Flip, bool Remap>
void update_nodes(const StepParameters<T>& step, const NodeView& view, const T* arenas, T* nodes) {
  constexpr int records = Flip ? 2 : 1;
  constexpr int values = records * record;
  T* out = nodes + static_cast<std::size_t>(view.slot) * cells_per_block<Dim> * values;
  for (int node = 0; node < cells_per_block<Dim>; ++node) {
    int c[3];
    cell_coordinates<T, Dim>(node, c);
    Record<T> sum[records];
    for (auto& r : sum) r = Record<T>{};
    for (int delta = 0; delta < (1 << Dim); ++delta) {
      const int di = delta >> (Dim - 1) & 1, dj = Dim == 3 ? delta >> 1 & 1 : 0, dk = delta & 1;
      const std::uint32_t slot = view.minus[delta];
      if (slot == no_slot) continue;
      const int i = c[0] + di * block_edge, j = c[1] + dj * block_edge, k = c[2] + dk * block_edge;
      if (i >= arena_edge || j >= arena_edge || k >= arena_edge) continue;
      const T* from = arenas + (static_cast<std::size_t>(slot) * nodes_per_arena<Dim> + arena_index<Dim>(i, j, k)) * values;
      for (int r = 0; r < (Remap ? 1 : records); ++r) sum[r] += record_at(from + r * record);
    }
    const T mass = sum[0][0];
    const T per_mass = mass > step.smallest_mass ? T(1) / mass : T(0);
    if constexpr (Flip && !Remap) {
      record_at(out + node * values) = (sum[0] + sum[1]) * per_mass;
      record_at(out + node * values + record) = sum[0] * per_mass;
      out[node * values + record] = T(0);
    } else {
      record_at(out + node * values) = sum[0] * per_mass;
    }
    out[node * values] = mass;
  }
}

/// Copies the nodes a block's particles can see into one arena and sets the walls' values.
template <class T, int Dim, class Shape>
void load_arena(const StepParameters<T>& step, const BlockView& block, const T* nodes, int records, T* arena) {
  const int values = records * record;
  for (int i = 0; i < arena_edge; ++i)
    for (int j = 0; j < (Dim == 3 ? arena_edge : 1); ++j)
      for (int half = 0; half < 2; ++half) {
        const int delta = Dim == 3 ? (i / block_edge) * 4 + (j / block_edge) * 2 + half : (i / block_edge) * 2 + half;
        const int run = (half == 0 ? block_edge : arena_edge - block_edge) * values;
        T* to = arena + arena_index<Dim>(i, j, half * block_edge) * values;
        const std::uint32_t slot = block.plus[delta];
        const int local = Dim == 3 ? (i % block_edge * block_edge + j % block_edge) * block_edge : i % block_edge * block_edge;
        const T* from = nodes + (static_cast<std::size_t>(slot) * cells_per_block<Dim> + local) * values;
        for (int n = 0; n < run; ++n) to[n] = from[n];
      }
  const int edge[3] = {arena_edge, Dim == 3 ? arena_edge : 1, arena_edge};
  for (int a = 0; a < Dim; ++a) {
    const int axis = Dim == 2 && a == 1 ? 2 : a;
    for (int side = 0; side < 2; ++side) {
      const PlaneWall wall = side == 0 ? step.bounds[a].lower : step.bounds[a].upper;
      if (wall == PlaneWall::none) continue;
      // Quadratic: the ghost node mirrors the first one inside. Linear: the node on the wall itself is held.
      const int face = (side == 0 ? step.bounds[a].lower_cell : step.bounds[a].upper_cell) - block.origin[a];
      const int cell = side == 0 ? face : face - 1;
      const int held = Shape::nodes == 3 ? (side == 0 ? cell : cell + 2) : face;
      const int image = cell + 1;
      if (Shape::nodes == 3 ? (cell < 0 || cell >= block_edge) : (face < 0 || face > block_edge)) continue;
      int n[3];
      for (n[0] = 0; n[0] < edge[0]; ++n[0])
        for (n[1] = 0; n[1] < edge[1]; ++n[1])
          for (n[2] = 0; n[2] < edge[2]; ++n[2]) {
            if (n[axis] != held) continue;
            T* to = arena + arena_index<Dim>(n[0], n[1], n[2]) * values;
            int m[3] = {n[0], n[1], n[2]};
            m[axis] = image;
            const T* from = arena + arena_index<Dim>(m[0], m[1], m[2]) * values;
            for (int r = 0; r < records; ++r)
              for (int c = 0; c < Dim; ++c) {
                const bool odd = wall == PlaneWall::no_slip || c == a;
                T& value = to[r * record + 1 + c];
                if constexpr (Shape::nodes == 3) {
                  value = odd ? -from[r * record + 1 + c] : from[r * record + 1 + c];
                } else if (odd) {
                  value = T(0);
                }
              }
          }
    }
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// Grid to particles

/// Where the gathered values go: per component the value, its gradient per cell and its weighted offsets.
template <class T, int Dim>
struct Gathered {
  T* value[Dim];
  T* gradient[Dim][Dim];
  T* affine[Dim][Dim];
};

/// Interpolates node velocities (of one record) to the particles [first, first + count) of one cell, a register of
/// particles at a time. Lanes past the cell's end hold rubbish that the next cell, or the padding, takes.
template <class T, int Dim, class Shape, bool Value, bool Gradient, bool Affine>
void gather(const T* arena_cell, int node_stride, const T* const* position, const Weights<T, Dim, Shape>& w, int first,
            int count, const Gathered<T, Dim>& out) {
  constexpr int nodes = Shape::nodes;
  constexpr int lanes = static_cast<int>(sizeof(Lanes<T>) / sizeof(T));
  constexpr int last = Dim - 1;
  using L = Lanes<T>;
  const L zero = {};
  for (int q = first; q < first + count; q += lanes) {
    for (int c = 0; c < Dim; ++c) {
      L value = zero, slope0 = zero, slope1 = zero, slope2 = zero, moment0 = zero, moment1 = zero, moment2 = zero;
#pragma GCC unroll 3
      for (int i = 0; i < nodes; ++i) {
        // Sums over the remaining axes of this slab: plain, with slopes, and with offsets (0, +-1 for quadratic nodes).
        L plain = zero, with_slope1 = zero, with_slope2 = zero, with_offset1 = zero, with_offset2 = zero;
#pragma GCC unroll 3
        for (int j = 0; j < (Dim == 3 ? nodes : 1); ++j) {
          const T* node = arena_cell + arena_index<Dim>(i, j, 0) * node_stride + 1 + c;
          L line = zero, line_slope = zero, line_offset = zero;
#pragma GCC unroll 3
          for (int k = 0; k < nodes; ++k) {
            const T u = node[k * node_stride];
            const L weighted = lanes_at(w.weight[last][k] + q) * u;
            line += weighted;
            if constexpr (Gradient) line_slope += lanes_at(w.slope[last][k] + q) * u;
            if constexpr (Affine) {
              if (k == 0) line_offset -= weighted;
              if (k == 2) line_offset += weighted;
            }
          }
          if constexpr (Dim == 3) {
            const L wj = lanes_at(w.weight[1][j] + q);
            const L weighted = wj * line;
            plain += weighted;
            if constexpr (Gradient) {
              with_slope1 += lanes_at(w.slope[1][j] + q) * line;
              with_slope2 += wj * line_slope;
            }
            if constexpr (Affine) {
              if (j == 0) with_offset1 -= weighted;
              if (j == 2) with_offset1 += weighted;
              with_offset2 += wj * line_offset;
            }
          } else {
            plain = line;
            with_slope1 = line_slope;
            with_offset1 = line_offset;
          }
        }
        const L wi = lanes_at(w.weight[0][i] + q);
        const L weighted = wi * plain;
        value += weighted;
        if constexpr (Gradient) {
          slope0 += lanes_at(w.slope[0][i] + q) * plain;
          slope1 += wi * with_slope1;
          if constexpr (Dim == 3) slope2 += wi * with_slope2;
        }
        if constexpr (Affine) {
          if (i == 0) moment0 -= weighted;
          if (i == 2) moment0 += weighted;
          moment1 += wi * with_offset1;
          if constexpr (Dim == 3) moment2 += wi * with_offset2;
        }
      }
      if constexpr (Value) lanes_at(out.value[c] + q) = value;
      if constexpr (Gradient) {
        lanes_at(out.gradient[c][0] + q) = slope0;
        lanes_at(out.gradient[c][1] + q) = slope1;
        if constexpr (Dim == 3) lanes_at(out.gradient[c][2] + q) = slope2;
      }
      if constexpr (Affine) {
        const T inverse = T(Quadratic::inverse_moment);
        lanes_at(out.affine[c][0] + q) = inverse * (moment0 - (lanes_at(position[0] + q) - T(0.5)) * value);
        lanes_at(out.affine[c][1] + q) = inverse * (moment1 - (lanes_at(position[1] + q) - T(0.5)) * value);
        if constexpr (Dim == 3)
          lanes_at(out.affine[c][2] + q) = inverse * (moment2 - (lanes_at(position[2] + q) - T(0.5)) * value);
      }
    }
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// Strain, stress, motion

/// A tile's state while its stress is updated.
template <class T, int Dim>
struct Strain {
  T* gradient[Dim][Dim];  ///< 1/s
  T* hoop;                ///< 1/s, axisymmetric only
  T* dilatation;          ///< 1/s, averaged
  T* deviator[Deviator<T, Dim>::components];
  T* ratio;
  T* pressure;
  T* rate;
  T* lambda;
  T* shear;   ///< G dt, Pa s
  T* trial;   ///< Pa
  T* stress;  ///< Pa
};

template <class T, int Dim>
FLOWREST_INLINE VelocityGradient<T, Dim> gradient_of(const Strain<T, Dim>& s, int q, bool axisymmetric) {
  VelocityGradient<T, Dim> l;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) l.g[i][j] = s.gradient[i][j][q];
  l.hoop = axisymmetric ? s.hoop[q] : T(0);
  return l;
}

/// Volume, pressure and the elastic trial. For an explicit fluid the "trial" is 2 D*, whose invariant is the shear rate.
template <class T, int Dim, bool Axisymmetric, StressRate Rate, bool Explicit>
void make_trial(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
  const T dt = step.step;
#pragma omp simd
  for (int q = 0; q < count; ++q) {
    const VelocityGradient<T, Dim> l = gradient_of(s, q, Axisymmetric);
    const T ratio = s.ratio[q] * (T(1) + dt * s.dilatation[q]);  // Yu et al. 2026, Eq. 30
    const auto state = step.state.at(ratio);
    const Deviator<T, Dim> rate = l.strain_rate_deviator();
    Deviator<T, Dim> dev;
    if constexpr (Explicit) {
      dev = rate.scaled(T(2));
    } else {
      if constexpr (Dim == 2) {
        dev = {s.deviator[0][q], s.deviator[1][q], s.deviator[2][q]};
      } else {
        dev = {s.deviator[0][q], s.deviator[1][q], s.deviator[2][q], s.deviator[3][q], s.deviator[4][q]};
      }
      if constexpr (Rate == StressRate::hughes_winget) {
        dev = rotated(dev, l, dt);
      } else {
        dev = jaumann(dev, l, dt);
      }
      dev = dev.plus(rate, T(2) * state.shear * dt);  // Eq. 37
    }
    s.ratio[q] = ratio;
    s.pressure[q] = state.pressure;
    s.shear[q] = state.shear * dt;
    s.trial[q] = square_root(dev.half_square());
    s.deviator[0][q] = dev.xx;
    s.deviator[1][q] = dev.yy;
    s.deviator[2][q] = dev.xy;
    if constexpr (Dim == 3) {
      s.deviator[3][q] = dev.xz;
      s.deviator[4][q] = dev.yz;
    }
  }
}

template <class T, int Dim, class Law>
void relax_closed(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
#pragma omp simd
  for (int q = 0; q < count; ++q) {
    const T lambda = Law::thixotropic ? s.lambda[q] : T(0);
    const Relaxed<T> r = Law::template relax<T>(step.flow, s.trial[q], s.shear[q], step.step, lambda, s.rate[q]);
    s.stress[q] = r.stress;
    s.rate[q] = r.rate;
    if constexpr (Law::thixotropic) s.lambda[q] = r.lambda;
  }
}

/// Staggered thixotropy of the fluids: lambda with the last step's rate, returned with the yield stress it gives.
template <class T, int Dim, bool Thixotropic>
FLOWREST_INLINE T fluid_yield(const StepParameters<T>& step, const Strain<T, Dim>& s, int q) {
  if constexpr (!Thixotropic) {
    return step.flow.yield_stress;
  } else {
    return step.flow.yield_stress * (T(1) + s.lambda[q]);
  }
}

template <class T, int Dim>
void flocculate(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
  const T dt = step.step;
#pragma omp simd
  for (int q = 0; q < count; ++q)
    s.lambda[q] = (s.lambda[q] + step.flow.flocculation_growth * dt) / (T(1) + dt * step.flow.deflocculation * s.rate[q]);
}

/// Newton's method on all particles of a tile at once until the slowest has converged.
template <class T, int Dim, bool Thixotropic>
void relax_papanastasiou(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
  using Law = Papanastasiou<Thixotropic>;
  if constexpr (Thixotropic) flocculate(step, s, count);
  const T tolerance = sizeof(T) == 8 ? T(1e-14) : T(2e-6);  // of the trial's stress
  for (int iteration = 0; iteration < 100; ++iteration) {
    T change = T(0);
#pragma omp simd reduction(max : change)
    for (int q = 0; q < count; ++q) {
      const T before = s.rate[q];
      const auto next = Law::template iterate<T>(step.flow, fluid_yield<T, Dim, Thixotropic>(step, s, q), s.trial[q], s.shear[q], before);
      const T relative = (next.residual > T(0) ? next.residual : -next.residual) / (s.trial[q] + T(1e-30));
      // A particle that balances stays as it is, so that its result does not depend on its neighbours in the tile.
      s.rate[q] = relative > tolerance ? next.rate : before;
      change = change > relative ? change : relative;
    }
    if (!(change > tolerance)) break;
  }
#pragma omp simd
  for (int q = 0; q < count; ++q) s.stress[q] = s.trial[q] - s.shear[q] * s.rate[q];
}

/// Explicit fluid: the stress of the present rate. `Regularised`: Papanastasiou, else bi-viscous or Newtonian.
template <class T, int Dim, bool Regularised, bool Thixotropic>
void relax_explicit(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
  if constexpr (Thixotropic) flocculate(step, s, count);
#pragma omp simd
  for (int q = 0; q < count; ++q) {
    const T rate = s.trial[q];
    const T yield = fluid_yield<T, Dim, Thixotropic>(step, s, q);
    s.rate[q] = rate;
    s.stress[q] = Regularised ? papanastasiou_stress(step.flow, yield, rate) : bi_viscous_stress(step.flow, yield, rate);
  }
}

template <class T, int Dim>
void relax(const StepParameters<T>& step, const Strain<T, Dim>& s, int count) {
  if (step.explicit_fluid) {
    switch (step.law) {
      case Law::papanastasiou: return relax_explicit<T, Dim, true, false>(step, s, count);
      case Law::papanastasiou_thixotropic: return relax_explicit<T, Dim, true, true>(step, s, count);
      case Law::bi_viscous_thixotropic: return relax_explicit<T, Dim, false, true>(step, s, count);
      default: return relax_explicit<T, Dim, false, false>(step, s, count);
    }
  }
  switch (step.law) {
    case Law::elasto_viscoplastic: return relax_closed<T, Dim, ElastoViscoplastic<false>>(step, s, count);
    case Law::elasto_viscoplastic_thixotropic: return relax_closed<T, Dim, ElastoViscoplastic<true>>(step, s, count);
    case Law::papanastasiou: return relax_papanastasiou<T, Dim, false>(step, s, count);
    case Law::papanastasiou_thixotropic: return relax_papanastasiou<T, Dim, true>(step, s, count);
    case Law::bi_viscous: return relax_closed<T, Dim, BiViscous<false>>(step, s, count);
    case Law::bi_viscous_thixotropic: return relax_closed<T, Dim, BiViscous<true>>(step, s, count);
    case Law::newtonian: return relax_closed<T, Dim, Newtonian>(step, s, count);
  }
}

/// Strain, stress and motion of a tile whose velocity gradients per cell are gathered. `advection` moves the particles.
template <class T, int Dim, bool Axisymmetric, class Shape>
void deform_and_move(const StepParameters<T>& step, const ParticleView<T>& particles, Tile<T, Dim>& tile,
                     const T* arena, int node_stride, T* const* x, const Gathered<T, Dim>& gathered,
                     const T* const* advection) {
  const int count = tile.count;
  Strain<T, Dim> s;
  const T per_cell = T(1) / step.cell;
  for (int i = 0; i < Dim; ++i)
    for (int j = 0; j < Dim; ++j) {
      T* g = s.gradient[i][j] = gathered.gradient[i][j];
#pragma omp simd
      for (int q = 0; q < count; ++q) g[q] *= per_cell;
    }
  s.dilatation = tile.fresh();
  s.hoop = nullptr;
  T* radial = nullptr;
  if constexpr (Axisymmetric) {
    s.hoop = tile.fresh();
    radial = tile.fresh();
    radial_cells(tile, radial);
    const T* radial_velocity = gathered.value[0];
#pragma omp simd
    for (int q = 0; q < count; ++q)
      s.hoop[q] = radial_velocity[q] / (step.cell * maximum(radial[q] + x[0][q], T(1e-6)));
  }
  const T* mass = tile.open(particles.mass);
  s.ratio = tile.open(particles.volume_ratio);
  T* volume = tile.fresh();
#pragma omp simd
  for (int q = 0; q < count; ++q) {
    volume[q] = mass[q] * s.ratio[q];
    s.dilatation[q] = gradient_of(s, q, Axisymmetric).divergence();
  }
  if (step.dilatation == Dilatation::cell_average) {
    average_over_cells(tile, volume, s.dilatation);
  } else {
    for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
      const int n = tile.cell_count(cell), first = tile.cell_first(cell);
      if (n == 0) continue;
      const T* base = arena + cell_base<T, Dim>(cell) * node_stride + 1;
      T divergence = T(0), radial_velocity = T(0);
      const T half = T(0.5);
      for (int i = 0; i < Shape::nodes; ++i)
        for (int j = 0; j < (Dim == 3 ? Shape::nodes : 1); ++j)
          for (int k = 0; k < Shape::nodes; ++k) {
            const T* v = base + arena_index<Dim>(i, j, k) * node_stride;
            const T wi = Shape::weight(i, half), wj = Dim == 3 ? Shape::weight(j, half) : T(1), wk = Shape::weight(k, half);
            divergence += v[0] * Shape::slope(i, half) * wj * wk + v[Dim - 1] * wi * wj * Shape::slope(k, half);
            if constexpr (Dim == 3) divergence += v[1] * wi * Shape::slope(j, half) * wk;
            if constexpr (Axisymmetric) radial_velocity += v[0] * wi * wk;
          }
      divergence *= per_cell;
      if constexpr (Axisymmetric) divergence += radial_velocity * per_cell / (radial[first] + half);
      for (int q = first; q < first + n; ++q) s.dilatation[q] = divergence;
    }
  }

  constexpr int components = Deviator<T, Dim>::components;
  for (int c = 0; c < components; ++c) s.deviator[c] = tile.open(particles.deviator[c]);
  s.pressure = tile.fresh();
  s.rate = tile.open(particles.rate);
  const bool thixotropic = particles.lambda != nullptr;
  s.lambda = thixotropic ? tile.open(particles.lambda) : nullptr;
  s.shear = tile.fresh();
  s.trial = tile.fresh();
  s.stress = tile.fresh();
  if (step.explicit_fluid) {
    make_trial<T, Dim, Axisymmetric, StressRate::hughes_winget, true>(step, s, count);
  } else if (step.stress_rate == StressRate::hughes_winget) {
    make_trial<T, Dim, Axisymmetric, StressRate::hughes_winget, false>(step, s, count);
  } else {
    make_trial<T, Dim, Axisymmetric, StressRate::jaumann, false>(step, s, count);
  }
  relax(step, s, count);

  T dissipated = T(0), largest_pressure = T(0), largest_speed = T(0);
  const T dt = step.step;
#pragma omp simd reduction(+ : dissipated) reduction(max : largest_pressure)
  for (int q = 0; q < count; ++q) {
    const T scale = s.stress[q] / maximum(s.trial[q], T(1e-30));
    for (int c = 0; c < components; ++c) s.deviator[c][q] *= scale;
    dissipated += mass[q] * s.ratio[q] * s.stress[q] * s.rate[q];
    largest_pressure = largest_pressure > s.pressure[q] ? largest_pressure : s.pressure[q];
  }
  tile.close(particles.volume_ratio, s.ratio);
  for (int c = 0; c < components; ++c) tile.close(particles.deviator[c], s.deviator[c]);
  tile.close(particles.pressure, s.pressure);
  tile.close(particles.rate, s.rate);
  if (thixotropic) tile.close(particles.lambda, s.lambda);

  // Motion. `left` counts axes along which a particle left its cell; a value that is not finite fails every comparison.
  T* left = s.shear;
  T momentum = T(0);
  const T per_step = dt * per_cell;
#pragma omp simd reduction(max : largest_speed) reduction(+ : momentum)
  for (int q = 0; q < count; ++q) {
    T square = T(0), outside = T(0);
    for (int a = 0; a < Dim; ++a) {
      const T v = advection[a][q];
      const T to = x[a][q] + v * per_step;
      square += v * v;
      outside += (to >= T(0) && to < T(1)) ? T(0) : T(1);
      x[a][q] = to;
    }
    left[q] = outside;
    momentum += mass[q] * advection[0][q];
    largest_speed = largest_speed > square ? largest_speed : square;
  }
  BlockSums& sums = *tile.block.sums;
  for (int q = 0; q < count; ++q) {
    if (left[q] == T(0)) continue;
    Mover mover{tile.block.list[tile.first + q], {0, 0, 0}};
    for (int a = 0; a < Dim; ++a) {
      T& to = x[a][q];
      if (to >= T(0) && to < T(1)) continue;
      const int shift = to < T(0) ? -1 : 1;
      const T inside = to - T(shift);
      if (!(inside >= T(0) && inside <= T(1))) ++sums.faults;  // further than a cell, or not finite
      const T below_one = sizeof(T) == 8 ? T(1 - 0x1p-53) : T(1 - 0x1p-24f);
      to = minimum(maximum(inside, T(Shape::margin)), minimum(T(1.0 - Shape::margin), below_one));
      mover.shift[a] = static_cast<std::int8_t>(shift);
    }
    tile.block.movers[sums.movers++] = mover;
  }
  for (int a = 0; a < Dim; ++a) tile.close(particles.position[a], x[a]);

  sums.momentum += static_cast<double>(momentum);
  sums.dissipated += static_cast<double>(dissipated) * static_cast<double>(dt / step.density);
  if (static_cast<double>(largest_pressure) > sums.largest_pressure) sums.largest_pressure = static_cast<double>(largest_pressure);
  if (static_cast<double>(largest_speed) > sums.largest_speed_squared) sums.largest_speed_squared = static_cast<double>(largest_speed);
}

template <class T, int Dim>
Gathered<T, Dim> room_for_gathered(Tile<T, Dim>& tile, bool value, bool gradient, bool affine) {
  Gathered<T, Dim> g{};
  for (int c = 0; c < Dim; ++c) {
    if (value) g.value[c] = tile.fresh();
    for (int a = 0; a < Dim; ++a) {
      if (gradient) g.gradient[c][a] = tile.fresh();
      if (affine) g.affine[c][a] = tile.fresh();
    }
  }
  return g;
}

template <class T, int Dim, bool Axisymmetric>
void apic_to_particles(const StepParameters<T>& step, const ParticleView<T>& particles, const BlockView& block, T* /*arenas*/,
                       const T* nodes, const Workspace<T>& workspace) {
  alignas(64) T arena[nodes_per_arena<Dim> * record];
  load_arena<T, Dim, Quadratic>(step, block, nodes, 1, arena);
  Tile<T, Dim> tile(block, workspace);
  while (tile.next()) {
    T* x[Dim];
    for (int a = 0; a < Dim; ++a) x[a] = tile.open(particles.position[a]);
    Weights<T, Dim, Quadratic> weights;
    weights.make(tile, x);
    const Gathered<T, Dim> g = room_for_gathered<T, Dim>(tile, true, true, true);
    for (int cell = tile.first_cell; cell < tile.last_cell; ++cell)
      if (tile.cell_count(cell) > 0)
        gather<T, Dim, Quadratic, true, true, true>(arena + cell_base<T, Dim>(cell) * record, record, x, weights,
                                                    tile.cell_first(cell), tile.cell_count(cell), g);
    for (int c = 0; c < Dim; ++c) {
      tile.close(particles.velocity[c], g.value[c]);
      for (int a = 0; a < Dim; ++a) tile.close(particles.affine[c * Dim + a], g.affine[c][a]);
    }
    deform_and_move<T, Dim, Axisymmetric, Quadratic>(step, particles, tile, arena, record, x, g, g.value);
  }
}

/// FLIP's velocities: v <- keep (v + dv) + (1 - keep) v_grid, then their momentum mapped back for the strain (MUSL).
template <class T, int Dim>
void flip_to_particles(const StepParameters<T>& step, const ParticleView<T>& particles, const BlockView& block, T* arenas,
                       const T* nodes, const Workspace<T>& workspace) {
  constexpr int values = 2 * record;
  alignas(64) T arena[nodes_per_arena<Dim> * values];
  load_arena<T, Dim, Linear>(step, block, nodes, 2, arena);
  T* remapped = arenas + static_cast<std::size_t>(block.slot) * nodes_per_arena<Dim> * values;
  for (int i = 0; i < nodes_per_arena<Dim> * values; ++i) remapped[i] = T(0);
  using Momentum = Source<T, Dim, Linear, false>;
  Tile<T, Dim> tile(block, workspace);
  while (tile.next()) {
    T *x[Dim], *v[Dim];
    for (int a = 0; a < Dim; ++a) x[a] = tile.open(particles.position[a]);
    for (int a = 0; a < Dim; ++a) v[a] = tile.open(particles.velocity[a]);
    const T* mass = tile.open(particles.mass);
    Weights<T, Dim, Linear> weights;
    weights.make(tile, x);
    const Gathered<T, Dim> fresh = room_for_gathered<T, Dim>(tile, true, false, false);
    const Gathered<T, Dim> old = room_for_gathered<T, Dim>(tile, true, false, false);
    for (int cell = tile.first_cell; cell < tile.last_cell; ++cell) {
      const int n = tile.cell_count(cell), first = tile.cell_first(cell);
      if (n == 0) continue;
      const T* base = arena + cell_base<T, Dim>(cell) * values;
      gather<T, Dim, Linear, true, false, false>(base, values, x, weights, first, n, fresh);
      gather<T, Dim, Linear, true, false, false>(base + record, values, x, weights, first, n, old);
    }
    Momentum* momentum = reinterpret_cast<Momentum*>(tile.memory + tile.capacity * tile.used);
    for (int c = 0; c < Dim; ++c) {
#pragma omp simd
      for (int q = 0; q < tile.count; ++q)
        v[c][q] = step.keep * (v[c][q] + fresh.value[c][q] - old.value[c][q]) + (T(1) - step.keep) * fresh.value[c][q];
      tile.close(particles.velocity[c], v[c]);
      tile.close(particles.advection[c], fresh.value[c]);
    }
    for (int q = 0; q < tile.count; ++q) {
      momentum[q].value[0] = mass[q];
      momentum[q].value[3] = T(0);
      for (int c = 0; c < Dim; ++c) momentum[q].value[1 + c] = mass[q] * v[c][q];
    }
    for (int cell = tile.first_cell; cell < tile.last_cell; ++cell)
      if (tile.cell_count(cell) > 0)
        scatter<T, Dim, Linear, false>(remapped + cell_base<T, Dim>(cell) * values, values, momentum, weights,
                                       tile.cell_first(cell), tile.cell_count(cell));
  }
}

template <class T, int Dim, bool Axisymmetric>
void remapped_to_particles(const StepParameters<T>& step, const ParticleView<T>& particles, const BlockView& block,
                           T* /*arenas*/, const T* nodes, const Workspace<T>& workspace) {
  constexpr int values = 2 * record;
  alignas(64) T arena[nodes_per_arena<Dim> * values];
  load_arena<T, Dim, Linear>(step, block, nodes, 2, arena);
  Tile<T, Dim> tile(block, workspace);
  while (tile.next()) {
    T *x[Dim], *advection[Dim];
    for (int a = 0; a < Dim; ++a) x[a] = tile.open(particles.position[a]);
    for (int a = 0; a < Dim; ++a) advection[a] = tile.open(particles.advection[a]);
    Weights<T, Dim, Linear> weights;
    weights.make(tile, x);
    const Gathered<T, Dim> g = room_for_gathered<T, Dim>(tile, Axisymmetric, true, false);
    for (int cell = tile.first_cell; cell < tile.last_cell; ++cell)
      if (tile.cell_count(cell) > 0)
        gather<T, Dim, Linear, Axisymmetric, true, false>(arena + cell_base<T, Dim>(cell) * values, values, x, weights,
                                                          tile.cell_first(cell), tile.cell_count(cell), g);
    deform_and_move<T, Dim, Axisymmetric, Linear>(step, particles, tile, arena, values, x, g, advection);
  }
}

template <class T, int Dim, bool Axisymmetric>
Kernels<T> make_kernels(Transfer transfer) {
  if (transfer == Transfer::quadratic_apic)
    return {Dim, 1, particles_to_grid<T, Dim, Axisymmetric, Quadratic, false>, update_nodes<T, Dim, false, false>,
            apic_to_particles<T, Dim, Axisymmetric>, nullptr, nullptr};
  return {Dim, 2, particles_to_grid<T, Dim, Axisymmetric, Linear, true>, update_nodes<T, Dim, true, false>,
          flip_to_particles<T, Dim>, update_nodes<T, Dim, true, true>, remapped_to_particles<T, Dim, Axisymmetric>};
}

template <class T>
Kernels<T> select_kernels(int dimension, bool axisymmetric, Transfer transfer) {
  if (dimension == 3) return make_kernels<T, 3, false>(transfer);
  return axisymmetric ? make_kernels<T, 2, true>(transfer) : make_kernels<T, 2, false>(transfer);
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
