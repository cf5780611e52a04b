#include "compare/words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace flowrest::compare::words {

namespace {

/// `digits` significant digits without an exponent.
std::string significant(double value, int digits) {
  if (value == 0.0 || !std::isfinite(value)) return fmt::format("{:g}", value);
  const int before = static_cast<int>(std::floor(std::log10(std::abs(value)))) + 1;
  return fmt::format("{:.{}f}", value, std::max(0, digits - before));
}

}  // namespace

std::string spread(double metres) { return fmt::format("{:.0f} mm", 1000.0 * metres); }

std::string spread(double metres, const std::optional<double>& uncertainty) {
  if (!uncertainty || !(*uncertainty > 0.0)) return spread(metres);
  // One digit of the uncertainty, two where it begins with 1, never below a millimetre; the value ends at the
  // same place.
  const double mm = std::max(1000.0 * *uncertainty, 1.0);
  const double leading = std::pow(10.0, std::floor(std::log10(mm)));
  const double place = std::max(mm < 1.95 * leading ? 0.1 * leading : leading, 1.0);
  return fmt::format("{:.0f} ± {:.0f} mm", place * std::round(1000.0 * metres / place),
                     place * std::round(mm / place));
}

std::string reading(double value, const std::optional<double>& uncertainty, const std::string& unit) {
  const std::string after = unit.empty() ? "" : " " + unit;
  if (!uncertainty || !(*uncertainty > 0.0) || !std::isfinite(*uncertainty))
    return unit == "mm" ? fmt::format("{:.0f}{}", value, after)
                        : significant(value, unit == "s" ? 2 : 3) + after;
  // One digit of the uncertainty, two where it begins with 1; the value ends at the same place.
  const double leading = std::pow(10.0, std::floor(std::log10(*uncertainty)));
  const double least = unit == "mm" ? 1.0 : unit == "s" ? 0.01 : 0.0;
  const double place = std::max(*uncertainty < 1.95 * leading ? 0.1 * leading : leading, least);
  const int decimals = std::max(0, -static_cast<int>(std::floor(std::log10(place) + 1e-9)));
  return fmt::format("{:.{}f} ± {:.{}f}{}", place * std::round(value / place), decimals,
                     place * std::max(1.0, std::round(*uncertainty / place)), decimals, after);
}

std::string of(const Gauge& gauge, double value, const std::optional<double>& uncertainty) {
  if (gauge.unit == "mm") return spread(value, uncertainty);
  if (gauge.unit == "m/s") return velocity(value);
  const auto shown = uncertainty ? std::optional(gauge.shown * *uncertainty) : std::nullopt;
  return reading(gauge.shown * value, shown, gauge.unit);
}

std::string time(double seconds) {
  return seconds < 9.95 ? fmt::format("{:.1f} s", seconds) : fmt::format("{:.0f} s", seconds);
}

std::string speed(double m_per_s) {
  const double mm = 1000.0 * m_per_s;
  if (std::abs(mm) < 1e-3) return "less than 0.001 mm/s";
  return significant(mm, std::abs(mm) < 0.01 ? 1 : 2) + " mm/s";
}

std::string velocity(double m_per_s) {
  if (std::abs(m_per_s) < 1e-6) return "less than 0.001 mm/s";
  if (std::abs(m_per_s) < 0.1) return significant(1000.0 * m_per_s, 3) + " mm/s";
  return significant(m_per_s, 4) + " m/s";
}

std::string duration(double seconds) {
  if (seconds < 100.0) return significant(seconds, 2) + " s";
  if (seconds < 6000.0) return significant(seconds / 60.0, 2) + " min";
  return significant(seconds / 3600.0, 2) + " h";
}

std::string percent(double fraction) { return significant(100.0 * fraction, 2) + " %"; }

std::string listed(const std::vector<std::string>& items, const std::string& separator) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += i + 1 == items.size() && separator == ", " ? " and " : separator;
    text += items[i];
  }
  return text;
}

}  // namespace flowrest::compare::words
