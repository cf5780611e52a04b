#pragma once

#include "mpm/boundary/contact_points.h"
#include "mpm/simd/lanes.h"

namespace flowrest::mpm::FLOWREST_KERNEL_SPACE {

template <class T>
FLOWREST_INLINE T dot(const Record<T>& a, const Record<T>& b) {
  const Record<T> product = a * b;
  return (product[0] + product[1]) + product[2];
}

template <class T>
FLOWREST_INLINE Record<T>& velocity_of(const ContactView<T>& view, std::uint32_t node) {
  return record_at(view.velocity + std::size_t{4} * node);
}

/// A weight, or the four of a folded node.
template <bool Folded, class T>
FLOWREST_INLINE auto weight_at(const T* weights, std::uint32_t entry) {
  if constexpr (Folded) {
    return record_at(weights + 4 * entry);
  } else {
    return weights[entry];
  }
}

template <bool Folded, class T>
FLOWREST_INLINE Record<T> interpolated(const ContactView<T>& view, const ContactPoint<T>& p) {
  const std::uint32_t* const node = view.node + p.first;
  const T* const weight = view.effective + p.first_weight;
  // Two sums, for each has to wait for itself.
  Record<T> even = {}, odd = {};
  std::uint32_t e = 0;
  for (; e + 1 < p.count; e += 2) {
    even += weight_at<Folded>(weight, e) * velocity_of(view, node[e]);
    odd += weight_at<Folded>(weight, e + 1) * velocity_of(view, node[e + 1]);
  }
  if (e < p.count) even += weight_at<Folded>(weight, e) * velocity_of(view, node[e]);
  return even + odd;
}

template <bool Folded, class T>
FLOWREST_INLINE void push_nodes(const ContactView<T>& view, const ContactPoint<T>& p,
                                const Record<T>& impulse) {
  const std::uint32_t* const node = view.node + p.first;
  const T* const response = view.response + p.first_weight;
  for (std::uint32_t e = 0; e < p.count; ++e)
    velocity_of(view, node[e]) += weight_at<Folded>(response, e) * impulse;
}

template <bool Folded, class T>
FLOWREST_INLINE void weigh_point(const ContactView<T>& view, T light_share, ContactPoint<T>& p) {
  constexpr T smallest_share = T(1e-12);  // of the heaviest node: one with less is not moved
  constexpr int parts = Folded ? 4 : 1;
  const std::uint32_t* const node = view.node + p.first;
  const T* const weight = view.weight + p.first_weight;
  T* const effective = view.effective + p.first_weight;
  T* const response = view.response + p.first_weight;
  T heaviest = T(0);
#pragma omp simd reduction(max : heaviest)
  for (std::uint32_t e = 0; e < p.count; ++e) heaviest = maximum(heaviest, view.mass[node[e]]);
  p.mobility = T(0);
  if (!(heaviest > T(0))) return;
  // Shape functions sum to one; so do what is left of them, but for folded nodes, whose sum stays.
  T before = p.missing, after = T(0);
#pragma omp simd reduction(+ : before, after)
  for (std::uint32_t e = 0; e < p.count; ++e) {
    const T mass = view.mass[node[e]], fading = mass / (mass + light_share * heaviest);
    T largest = T(0);
    for (int c = 0; c < parts; ++c) {
      const T w = weight[parts * e + c];
      largest = maximum(largest, maximum(w, -w));
      effective[parts * e + c] = w * fading;
    }
    before += largest;
    after += largest * fading;
  }
  const T scale = before / after;
  T mobility[parts] = {};
  for (int c = 0; c < parts; ++c) {
    T sum = T(0);
#pragma omp simd reduction(+ : sum)
    for (std::uint32_t e = 0; e < p.count; ++e) {
      const T per_mass = view.mass[node[e]] > smallest_share * heaviest ? view.per_mass[node[e]] : T(0);
      const T w = effective[parts * e + c] * scale;
      effective[parts * e + c] = w;
      response[parts * e + c] = w * per_mass;
      sum += w * w * per_mass;
    }
    mobility[c] = sum;
  }
  // The largest for all directions: they differ only beside folded nodes, where a smaller one errs on the
  // side of more sweeps.
  for (int c = 0; c < (Folded ? view.dimension : 1); ++c) p.mobility = maximum(p.mobility, mobility[c]);
  p.per_mobility = T(1) / p.mobility;
}

/// The impulse that a point's wall allows of the one after which it would move with the wall.
template <class T>
FLOWREST_INLINE Record<T> lawful(ContactPoint<T>& p, const Record<T>& wanted) {
  p.pressed = p.stuck = true;
  if (p.sticks) return wanted;
  const Record<T> normal = record_at(p.normal);
  const T off = dot<T>(wanted, normal), pressed = maximum(off, T(0));
  const Record<T> along = wanted - off * normal;
  const T length = square_root(dot<T>(along, along)), limit = p.friction * pressed;
  const bool slides = length > limit;
  p.pressed = off > T(0);
  p.stuck = p.pressed && !slides && p.friction > T(0);
  return pressed * normal + (slides ? limit / length : T(1)) * along;
}

/// Returns the square of the change of velocity.
template <bool Folded, class T>
FLOWREST_INLINE T relax_point(const ContactView<T>& view, Relaxation how, ContactPoint<T>& p) {
  if (how == Relaxation::as_before && !p.pressed) return T(0);
  const Record<T> before = record_at(p.impulse);
  Record<T> wanted = before - (interpolated<Folded>(view, p) - record_at(p.wall_velocity)) * p.per_mobility;
  if (how == Relaxation::lawful) {
    wanted = lawful(p, wanted);
  } else if (!p.stuck) {
    wanted = dot<T>(wanted, record_at(p.normal)) * record_at(p.normal);
  }
  const Record<T> change = wanted - before;
  const T square = dot<T>(change, change);
  if (square > T(0)) push_nodes<Folded>(view, p, change);
  record_at(p.impulse) = wanted;
  return square * p.mobility * p.mobility;
}

template <class T>
void weigh_points(const ContactView<T>& view, T light_share, const std::uint32_t* points, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    ContactPoint<T>& p = view.points[points[i]];
    p.folded ? weigh_point<true>(view, light_share, p) : weigh_point<false>(view, light_share, p);
  }
}

template <class T>
void push_points(const ContactView<T>& view, const std::uint32_t* points, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const ContactPoint<T>& p = view.points[points[i]];
    const Record<T> impulse = record_at(p.impulse);
    p.folded ? push_nodes<true>(view, p, impulse) : push_nodes<false>(view, p, impulse);
  }
}

template <class T>
T sweep_points(const ContactView<T>& view, const Sweeping<T>& sweep, const std::uint32_t* points,
               std::size_t count) {
  T worst = T(0);
  for (std::size_t i = 0; i < count; ++i) {
    ContactPoint<T>& p = view.points[points[sweep.backwards ? count - 1 - i : i]];
    if (p.change <= sweep.settled) continue;
    p.change = p.folded ? relax_point<true>(view, sweep.how, p) : relax_point<false>(view, sweep.how, p);
    worst = maximum(worst, p.change);
  }
  return worst;
}

template <class T>
double work_at_points(const ContactView<T>& view, const std::uint32_t* points, std::size_t count) {
  double work = 0.0;
  for (std::size_t i = 0; i < count; ++i) {
    const ContactPoint<T>& p = view.points[points[i]];
    const Record<T> v = p.folded ? interpolated<true>(view, p) : interpolated<false>(view, p);
    for (int c = 0; c < 3; ++c) work += static_cast<double>(p.impulse[c]) * static_cast<double>(v[c]);
  }
  return work;
}

template <class T>
ContactKernels<T> contact_kernels() {
  return {weigh_points<T>, push_points<T>, sweep_points<T>, work_at_points<T>};
}

}  // namespace flowrest::mpm::FLOWREST_KERNEL_SPACE
