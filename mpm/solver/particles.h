#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "mpm/solver/sparse_blocks.h"
#include "mpm/solver/team.h"

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

/// The particles as a structure of arrays, with more places than particles: where they lie is for
/// SparseBlocks to say.
template <class T>
class Particles {
 public:
  Particles() = default;
  /// Without room for any until it is made.
  explicit Particles(const ParticleLayout& layout) : layout_(layout) {
    const auto add = [&](T*& member) { members_.push_back(&member); };
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
  }
  Particles(const Particles&) = delete;
  Particles& operator=(const Particles&) = delete;

  const ParticleLayout& layout() const { return layout_; }
  const ParticleView<T>& view() const { return view_; }
  std::size_t bytes() const { return (arrays_.size() * room_ + spare_.size()) * sizeof(T); }
  int array_count() const { return static_cast<int>(members_.size()); }
  T* array(int i) { return arrays_[static_cast<std::size_t>(i)].data(); }
  const T* array(int i) const { return arrays_[static_cast<std::size_t>(i)].data(); }

  /// Makes arrays of so many places, all zero.
  void make_room(std::size_t places) {
    room_ = places;
    arrays_.clear();
    for (std::size_t k = 0; k < members_.size(); ++k) {
      arrays_.emplace_back(places);
      *members_[k] = arrays_[k].data();
    }
  }

  /// Sets aside what is between two blocks, and moves whole blocks to new places. Call `settle` next.
  void make_way(const SparseBlocks& blocks, const SparseBlocks::Relocation& plan, Team& team) {
    departed_.resize(plan.departing.size() * arrays_.size());
    // A thread takes what departs from its own blocks.
    team.run(plan.departing.empty() ? 0 : plan.departing_end.size(), [&](std::uint32_t share, int) {
      for (std::size_t i = share == 0 ? 0 : plan.departing_end[share - 1]; i < plan.departing_end[share]; ++i)
        for (std::size_t k = 0; k < arrays_.size(); ++k)
          departed_[i * arrays_.size() + k] = arrays_[k][plan.departing[i]];
    });
    if (plan.laid_out_anew) {
      lay_out_anew(plan.new_places, blocks.room(), team);
      return;
    }
    team.run(plan.new_places.empty() ? 0 : arrays_.size(), [&](std::uint32_t k, int) {
      T* const array = arrays_[k].data();
      for (const auto& move : plan.new_places)
        std::memmove(array + move.to, array + move.from, move.count * sizeof(T));
    });
  }

  /// Puts one block's particles where they belong since the last relocation. Blocks may be settled side by
  /// side, each thread with a `table` of its own.
  void settle(SparseBlocks::Reordering& order, std::vector<T>& table) {
    if (order.pieces.empty()) return;
    // Laid out on the table in their new order, then put back where the order has changed. Most pieces are
    // shorter than a chunk: what is copied too much, the next one covers.
    constexpr std::size_t chunk = 64 / sizeof(T);
    std::size_t all = chunk;
    for (const auto& piece : order.pieces) all += piece.count;
    if (table.size() < all) table.resize(all + all / 4);
    for (std::size_t k = 0; k < arrays_.size(); ++k) {
      T* here = arrays_[k].data() + order.first;
      T* to = table.data();
      for (const auto& piece : order.pieces) {
        for (std::size_t i = 0; i < piece.count; i += chunk)
          std::memcpy(to + i, here + piece.from + i, sizeof(T) * chunk);
        to += piece.count;
      }
      const T* from = table.data();
      for (std::size_t p = 0; p < order.pieces.size();) {
        const std::uint32_t begin = order.pieces[p].to;
        std::uint32_t end = begin;
        for (; p < order.pieces.size() && order.pieces[p].to == end; ++p) end += order.pieces[p].count;
        std::copy_n(from, end - begin, here + begin);
        from += end - begin;
      }
      for (const auto& arrival : order.arrivals)
        here[arrival.to] = departed_[arrival.departed * arrays_.size() + k];
    }
    order.pieces.clear();
    order.arrivals.clear();
  }

 private:
  void lay_out_anew(const std::vector<SparseBlocks::NewPlace>& moves, std::size_t room, Team& team) {
    constexpr std::size_t together = 16;  // blocks that are short to copy
    for (std::size_t k = 0; k < arrays_.size(); ++k) {
      // One array to spare where the room stays: they take turns.
      if (spare_.size() != room) spare_ = AlignedArray<T>(room);
      const T* from = arrays_[k].data();
      T* to = spare_.data();
      team.run((moves.size() + together - 1) / together, [&](std::uint32_t piece, int) {
        for (std::size_t i = piece * together; i < std::min(moves.size(), (piece + 1) * together); ++i)
          std::copy_n(from + moves[i].from, moves[i].count, to + moves[i].to);
      });
      std::swap(arrays_[k], spare_);
      *members_[k] = arrays_[k].data();
    }
    room_ = room;
    spare_ = {};
  }

  ParticleLayout layout_;
  std::size_t room_ = 0;
  std::vector<AlignedArray<T>> arrays_;
  std::vector<T**> members_;
  ParticleView<T> view_;
  AlignedArray<T> spare_;
  std::vector<T> departed_;  ///< those that are between two blocks, all values of one after the other
};

}  // namespace flowrest::mpm
