#pragma once

#include <optional>
#include <string>
#include <vector>

#include "compare/measures/gauges.h"

/// Quantities in words: no more digits than the quantity carries.
namespace flowrest::compare::words {

/// The least that is told of lengths, speeds and times: of the standard apparatus, unless it is made for a
/// body of another size. A cone a hundredth as large has lengths a hundredth and speeds a tenth as large.
struct Grain {
  double length = 1e-3;  ///< m, a power of ten: the last digit of a length
  double speed = 1e-6;   ///< m/s, a power of ten
  double time = 5e-3;    ///< s
  int decimals() const;  ///< of a length in mm
};
Grain grain_of(const scenes::Gauges&, scenes::MainGauge);

std::string spread(double metres, const Grain& = {});  ///< "575 mm", of a small cone "5.42 mm"
/// With no digit that the uncertainty does not support: "563 ± 8 mm", "620 ± 30 mm"; without one as above.
std::string spread(double metres, const std::optional<double>& uncertainty, const Grain& = {});
/// A value of a gauge (SI) in the unit of its figures, as `spread` and `velocity` have it: "580 ± 10 mm", "98
/// %".
std::string of(const Gauge&, double value, const std::optional<double>& uncertainty = std::nullopt,
               const Grain& = {});
/// A reading in its unit, ended where its uncertainty begins: "1.42 ± 0.06 s", "70 ± 3 mm".
std::string reading(double value, const std::optional<double>& uncertainty, const std::string& unit,
                    const Grain& = {});
/// The decimals down to the first digit of an uncertainty: none from 1 on.
int decimals_down_to(double uncertainty);
std::string time(double seconds);  ///< "19 s", "4.6 s", "0.24 s"
/// "0.25 mm/s", of creep; "less than 0.001 mm/s" below what can be told from rest.
std::string speed(double m_per_s, const Grain& = {});
std::string velocity(double m_per_s);  ///< "1.333 m/s", "1.7 mm/s"
std::string duration(double seconds);  ///< "14 s", "4.4 min", "2.1 h"
std::string percent(double fraction);  ///< "1.3 %"
/// "a, b and c"; with another separator every item is parted by it.
std::string listed(const std::vector<std::string>& items, const std::string& separator = ", ");

}  // namespace flowrest::compare::words
