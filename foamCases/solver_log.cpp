#include "foamCases/solver_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iterator>
#include <utility>

namespace flowrest::foam {

namespace {

/// A fatal error's message: some lines of it tell more than the first.
constexpr int fatal_lines = 6;

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The number that follows `key` in `line`, if both are there.
std::optional<double> number_after(std::string_view line, std::string_view key) {
  const auto found = line.find(key);
  if (found == std::string_view::npos) return std::nullopt;
  const std::string rest(line.substr(found + key.size()));
  char* end = nullptr;
  const double value = std::strtod(rest.c_str(), &end);
  return end == rest.c_str() ? std::nullopt : std::optional(value);
}

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

}  // namespace

void SolverLog::feed(std::string_view text) {
  partial_.append(text);
  std::size_t begin = 0;
  for (auto end = partial_.find('\n'); end != std::string::npos; end = partial_.find('\n', begin)) {
    read_line(std::string_view(partial_).substr(begin, end - begin));
    begin = end + 1;
  }
  partial_.erase(0, begin);
}

void SolverLog::read_line(std::string_view line) {
  read_fault(line);
  if (line.starts_with("Build ")) {
    if (const auto colon = line.find(':'); colon != std::string_view::npos)
      build_ = trimmed(line.substr(colon + 1));
  } else if (line.starts_with("Courant Number")) {
    step_ = SolverStep{};
    step_.courant = number_after(line, "max:").value_or(0.0);
  } else if (line.starts_with("deltaT =")) {
    step_.time_step = number_after(line, "=").value_or(0.0);
  } else if (line.starts_with("Time = ")) {
    if (const auto time = number_after(line, "=")) {
      step_.time = *time;
      time_begun_ = *time;
      in_step_ = true;
    }
  } else if (const auto solved = line.find("Solving for U");
             solved != std::string_view::npos && solved + 13 < line.size() &&
             components_.find(line[solved + 13]) != std::string::npos) {
    step_.initial_residual_u =
        std::max(step_.initial_residual_u, number_after(line, "Initial residual =").value_or(0.0));
  } else if (line.starts_with("Chatter of U =")) {
    chatter_ = number_after(line, "=");
  } else if (line.starts_with("Noise of U =")) {
    noise_ = number_after(line, "=");
  } else if (line.starts_with("ExecutionTime") && in_step_) {
    execution_time_ = number_after(line, "=").value_or(execution_time_);
    step_.chatter = std::exchange(chatter_, std::nullopt);
    step_.noise = std::exchange(noise_, std::nullopt);
    steps_.push_back(step_);
    in_step_ = false;
  } else if (line == "End") {
    ended_ = true;
  }
}

void SolverLog::read_fault(std::string_view line) {
  for (const auto words : {"No space left on device", "Disk quota exceeded", "File too large",
                           "Input/output error", "Cannot allocate memory", "std::bad_alloc"})
    if (machine_.empty() && line.find(words) != std::string_view::npos) machine_ = trimmed(line);
  if (fatal_lines_left_ > 0) {
    --fatal_lines_left_;
    if (const auto text = trimmed(line); !text.empty())
      fatal_ += (fatal_.ends_with(':') ? " " : "; ") + std::string(text);
  } else if (fatal_.empty() && line.find("FOAM FATAL") != std::string_view::npos) {
    const auto begin = line.find("FOAM FATAL");
    fatal_ = trimmed(line.substr(begin));
    fatal_lines_left_ = fatal_lines;
  } else if (fatal_.empty() && line.find("sigFpe") != std::string_view::npos) {
    fatal_ = "floating point exception";
  }
  if (!not_a_number_.empty() || !in_step_) return;
  for (const auto key : {"Initial residual =", "max:", "deltaT ="})
    if (const auto value = number_after(line, key); value && !std::isfinite(*value))
      not_a_number_ = trimmed(line);
}

std::vector<SolverStep> SolverLog::take_steps() { return std::exchange(steps_, {}); }

std::string SolverLog::fault() const {
  if (!fatal_.empty()) return fatal_;
  return not_a_number_.empty() ? "" : "a number that is none: " + not_a_number_;
}

std::string FileTail::read() {
  std::ifstream file(path_, std::ios::binary);
  if (!file || !file.seekg(at_)) return "";
  std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  at_ += static_cast<std::streamoff>(text.size());
  return text;
}

void NoiseMonitor::add(const SolverStep& step) {
  block_.push_back(step);
  if (block_.size() == block_steps) end_block();
}

void NoiseMonitor::finish() {
  if (block_.size() >= fewest_steps) end_block();
}

void NoiseMonitor::end_block() {
  if (blocks_++ > 0) {
    std::vector<double> residuals, chatters;
    for (const auto& step : block_) {
      residuals.push_back(step.initial_residual_u);
      if (step.chatter) chatters.push_back(*step.chatter);
    }
    const double middle_residual = median(residuals);
    largest_residual_median_ = std::max(largest_residual_median_, middle_residual);
    measure_ = 2 * chatters.size() >= block_.size() ? &chatter : &residual;
    const double middle = measure_ == &chatter ? median(chatters) : middle_residual;
    largest_median_ = std::max(largest_median_, middle);
    if (middle > measure_->bound) {
      if (noisy_++ == 0) first_noisy_ = block_.front().time;
      last_noisy_ = block_.back().time;
      const auto measured = [](const SolverStep& step) { return step.noise.has_value(); };
      if (measure_ == &residual || std::none_of(block_.begin(), block_.end(), measured)) unmeasured_ = true;
      for (const auto& step : block_) path_ += step.noise.value_or(0.0) * step.time_step;
    }
  }
  block_.clear();
}

double NoiseMonitor::noisy_share() const {
  return blocks_ > 1 ? static_cast<double>(noisy_) / static_cast<double>(blocks_ - 1) : 0.0;
}

bool NoiseMonitor::noisy() const { return unmeasured_ || path_ > path_allowed * body_height_; }

std::string NoiseMonitor::verdict() const {
  if (blocks_ < 2)
    return fmt::format("unjudged: the run has fewer than {} steps", block_steps + fewest_steps);
  if (!noisy()) return "sound";
  const std::string moved =
      unmeasured_ ? "part of the spreading may be noise of the time step"
                  : fmt::format("it could have moved the concrete by {:.2g} mm, where {:.2g} are allowed",
                                1e3 * path_, 1e3 * path_allowed * body_height_);
  return fmt::format(
      "noisy: the {} passes {} (median of {} steps) in {:.0f} % of the run, between "
      "{:.2f} and "
      "{:.2f} s, and reaches {:.2g}; {}",
      measure_->name, measure_->bound, block_steps, std::max(1.0, 100.0 * noisy_share()), first_noisy_,
      last_noisy_, largest_median_, moved);
}

}  // namespace flowrest::foam
