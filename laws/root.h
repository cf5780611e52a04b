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

/// A rate above any that a trial is returned at: there the elastic relaxation alone would take more than all.
/// Not 0 where there is nothing to take, 1/s.
template <class T>
T most_of(const Trial<T>& trial) {
  return T(1) + T(2) * trial.stress / trial.shear;
}

/// The rate from 0 to `most` at which a falling balance vanishes: Newton's method, with a bisection wherever it
/// would leave what is known to hold the root, so that neither bend nor start can lead it astray. The balance
/// and not the rate says when it is found: near yield a rate is known less well than a stress by orders of
/// magnitude. The step taken from where it is found leaves nothing of the start's derivatives.
template <class T, class Function>
T root_of(const Function& balance, const T& start, const T& tolerance,
          const T& most = std::numeric_limits<T>::max()) {
  constexpr int most_steps = 300;
  T low(-1), high = most;  // below 0: no lower end is known yet
  T rate = start;
  for (int i = 0; i < most_steps; ++i) {
    const Balance<T> at = balance(rate);
    const T next = rate + at.rest / at.slope;
    if (!(larger(at.rest, -at.rest) > tolerance)) return larger(next, T(0));
    if (at.rest > T(0))
      low = rate;
    else
      high = smaller(high, rate);
    const T tried = larger(next, T(0));
    if (!(tried < rate || rate < tried)) return tried;  // to round-off
    rate = low < tried && tried < high ? tried : T(0.5) * (larger(low, T(0)) + high);
    if (!(low < rate && rate < high)) break;
  }
  return rate;
}

}  // namespace flowrest::laws
