#pragma once

#include "scenes/key_types.h"

/// What apparatus write their keys with.
namespace flowrest::scenes {

/// A length above 0 of an apparatus, kept where `at` says.
inline Key length_key(const char* name, Access<double> at, const char* meaning) {
  return number(std::string("geometry.") + name, "m", above(0.0, largest_length), at, meaning);
}

template <auto Member>
struct MemberOf;
template <class A, class T, T A::*Member>
struct MemberOf<Member> {
  using Owner = A;
};
/// Where a member of the scene's apparatus is kept.
template <auto Member>
auto& kept(Draft& draft) {
  return std::get<typename MemberOf<Member>::Owner>(draft.scene.geometry.apparatus).*Member;
}

}  // namespace flowrest::scenes
