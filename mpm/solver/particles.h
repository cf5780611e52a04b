#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "mpm/solver/layout.h"

namespace flowrest::mpm {

/// Memory aligned to a cache line, zeroed, with room for one register past the end.
template <class T>
class AlignedArray {
 public:
  AlignedArray() = default;
  explicit AlignedArray(std::size_t size) : size_(size) {
    const std::size_t bytes = ((size + 64) * sizeof(T) + 63) / 64 * 64;
    T* memory = static_cast<T*>(std::aligned_alloc(64, bytes));
    if (!memory) throw std::bad_alloc();
    for (std::size_t i = 0; i < bytes / sizeof(T); ++i) memory[i] = T(0);
    memory_.reset(memory);
  }
  T* data() { return memory_.get(); }
  const T* data() const { return memory_.get(); }
  std::size_t size() const { return size_; }
  T& operator[](std::size_t i) { return memory_.get()[i]; }
  const T& operator[](std::size_t i) const { return memory_.get()[i]; }

 private:
  struct Free {
    void operator()(T* p) const { std::free(p); }
  };
  std::unique_ptr<T, Free> memory_;
  std::size_t size_ = 0;
};

/// Which arrays a scene's particles have: what it does not use is not stored.
struct ParticleLayout {
  int dimension = 2;
  bool affine = true;         ///< APIC
  bool advection = false;     ///< FLIP
  bool flocculation = false;  ///< thixotropy
};

/// The particles as a structure of arrays.
template <class T>
class Particles {
 public:
  Particles() = default;
  Particles(const ParticleLayout& layout, std::size_t count) : layout_(layout), count_(count) {
    const auto add = [&](T*& member) {
      arrays_.emplace_back(count);
      members_.push_back(&member);
    };
    const int dim = layout.dimension;
    for (int a = 0; a < dim; ++a) add(view_.position[a]);
    for (int a = 0; a < dim; ++a) add(view_.velocity[a]);
    if (layout.affine)
      for (int a = 0; a < dim * dim; ++a) add(view_.affine[a]);
    for (int c = 0; c < (dim == 2 ? 3 : 5); ++c) add(view_.deviator[c]);
    add(view_.volume_ratio);
    add(view_.pressure);
    add(view_.mass);
    add(view_.rate);
    if (layout.flocculation) add(view_.lambda);
    if (layout.advection)
      for (int a = 0; a < dim; ++a) add(view_.advection[a]);
    for (std::size_t i = 0; i < arrays_.size(); ++i) *members_[i] = arrays_[i].data();
  }
  Particles(const Particles&) = delete;
  Particles& operator=(const Particles&) = delete;

  std::size_t size() const { return count_; }
  const ParticleLayout& layout() const { return layout_; }
  const ParticleView<T>& view() const { return view_; }
  std::size_t bytes() const { return arrays_.size() * count_ * sizeof(T); }
  int array_count() const { return static_cast<int>(arrays_.size()); }
  T* array(int i) { return arrays_[static_cast<std::size_t>(i)].data(); }
  const T* array(int i) const { return arrays_[static_cast<std::size_t>(i)].data(); }

  /// Rearranges every array so that new[i] = old[order[i]].
  void permute(const std::vector<std::uint32_t>& order, int threads) {
    if (scratch_.size() != count_) scratch_ = AlignedArray<T>(count_);
    for (std::size_t k = 0; k < arrays_.size(); ++k) {
      const T* from = arrays_[k].data();
      T* to = scratch_.data();
      const auto n = static_cast<std::int64_t>(count_);
#pragma omp parallel for schedule(static) num_threads(threads)
      for (std::int64_t i = 0; i < n; ++i) to[i] = from[order[static_cast<std::size_t>(i)]];
      std::swap(arrays_[k], scratch_);
      *members_[k] = arrays_[k].data();
    }
  }

 private:
  ParticleLayout layout_;
  std::size_t count_ = 0;
  std::vector<AlignedArray<T>> arrays_;
  std::vector<T**> members_;
  ParticleView<T> view_;
  AlignedArray<T> scratch_;
};

}  // namespace flowrest::mpm
