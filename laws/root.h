#pragma once

#include <limits>

#include "laws/parameters.h"

namespace flowrest::laws {

/// What is left of a balance at a rate.
template <class T>
struct Balance {
  T rest{};   ///< Pa, above 0 below the root
  T slope{};  ///< Pa s, how steeply it falls there
};

/// The rate, from 0, at which a falling balance vanishes: Newton's method, with a bisection wherever it would
/// leave what is known to hold the root, so that neither bend nor start can lead it astray. The balance and not
/// the rate says when it is found: near yield a rate is known less well than a stress by orders of magnitude.
/// The step taken from where it is found leaves nothing of the start's derivatives.
template <class T, class Function>
T root_of(const Function& balance, const T& start, const T& tolerance) {
  constexpr int most_steps = 300;
  T low(-1), high(std::numeric_limits<T>::max());  // below 0: no lower end is known yet
  T rate = start;
  for (int i = 0; i < most_steps; ++i) {
    const Balance<T> at = balance(rate);
    const T next = rate + at.rest / at.slope;
    if (!(larger(at.rest, -at.rest) > tolerance)) return larger(next, T(0));
    (at.rest > T(0) ? low : high) = rate;
    const T tried = larger(next, T(0));
    rate = low < tried && tried < high ? tried : T(0.5) * (low + high);
    if (!(low < rate && rate < high)) break;  // to round-off
  }
  return rate;
}

}  // namespace flowrest::laws
