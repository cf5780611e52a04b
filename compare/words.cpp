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

/// Decimals of a number whose last digit stands where this one has its first.
int decimals_of(double place) { return std::max(0, -static_cast<int>(std::floor(std::log10(place) + 1e-9))); }

}  // namespace

Grain grain_of(const scenes::Gauges& gauges, scenes::MainGauge judged_by) {
  const scenes::Gauges standard;
  // What falls a little short of a power of ten counts as it.
  const auto power_of_ten = [](double most) { return std::pow(10.0, std::floor(std::log10(most) + 0.05)); };
  Grain grain;
  grain.length = power_of_ten(gauges.edge_depth(judged_by) / 3.0);
  grain.speed = power_of_ten(gauges.still_speed / 100.0);
  grain.time *= gauges.rate_window / standard.rate_window;
  return grain;
}

int Grain::decimals() const { return decimals_of(1e3 * length); }

int decimals_down_to(double uncertainty) { return uncertainty > 0.0 ? decimals_of(uncertainty) : 0; }

std::string spread(double metres, const Grain& grain) {
  return fmt::format("{:.{}f} mm", 1000.0 * metres, grain.decimals());
}

std::string spread(double metres, const std::optional<double>& uncertainty, const Grain& grain) {
  if (!uncertainty || !(*uncertainty > 0.0)) return spread(metres, grain);
  // One digit of the uncertainty, two where it begins with 1, never below the grain; the value ends at the
  // same place.
  const double finest = 1000.0 * grain.length;
  const double mm = std::max(1000.0 * *uncertainty, finest);
  const double leading = std::pow(10.0, std::floor(std::log10(mm)));
  const double place = std::max(mm < 1.95 * leading ? 0.1 * leading : leading, finest);
  const int decimals = decimals_of(place);
  return fmt::format("{:.{}f} ± {:.{}f} mm", place * std::round(1000.0 * metres / place), decimals,
                     place * std::round(mm / place), decimals);
}

std::string reading(double value, const std::optional<double>& uncertainty, const std::string& unit,
                    const Grain& grain) {
  const std::string after = unit.empty() ? "" : " " + unit;
  if (!uncertainty || !(*uncertainty > 0.0) || !std::isfinite(*uncertainty))
    return unit == "mm" ? fmt::format("{:.{}f}{}", value, grain.decimals(), after)
                        : significant(value, unit == "s" ? 2 : 3) + after;
  // One digit of the uncertainty, two where it begins with 1; the value ends at the same place.
  const double leading = std::pow(10.0, std::floor(std::log10(*uncertainty)));
  const double least = unit == "mm"  ? 1000.0 * grain.length
                       : unit == "s" ? std::pow(10.0, std::floor(std::log10(2.0 * grain.time) + 1e-9))
                                     : 0.0;
  const double place = std::max(*uncertainty < 1.95 * leading ? 0.1 * leading : leading, least);
  const int decimals = decimals_of(place);
  return fmt::format("{:.{}f} ± {:.{}f}{}", place * std::round(value / place), decimals,
                     place * std::max(1.0, std::round(*uncertainty / place)), decimals, after);
}

std::string of(const Gauge& gauge, double value, const std::optional<double>& uncertainty,
               const Grain& grain) {
  if (gauge.unit == "mm") return spread(value, uncertainty, grain);
  if (gauge.unit == "m/s") return velocity(value);
  const auto shown = uncertainty ? std::optional(gauge.shown * *uncertainty) : std::nullopt;
  return reading(gauge.shown * value, shown, gauge.unit, grain);
}

std::string time(double seconds) {
  if (seconds > 0.0 && seconds < 0.95) return fmt::format("{:.2g} s", seconds);
  return seconds < 9.95 ? fmt::format("{:.1f} s", seconds) : fmt::format("{:.0f} s", seconds);
}

std::string speed(double m_per_s, const Grain& grain) {
  const double mm = 1000.0 * m_per_s, least = 1000.0 * grain.speed;
  if (std::abs(mm) < least) return fmt::format("less than {:g} mm/s", least);
  return significant(mm, std::abs(mm) < 10.0 * least ? 1 : 2) + " mm/s";
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
