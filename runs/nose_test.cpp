#include "runs/nose.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "runs/depth.h"

using namespace flowrest::runs;

namespace {

using Shape = std::function<double(double place, double end)>;

/// Mean depths over rings or strips, as fractions of cells give them.
std::vector<double> as_fractions(const Shape& shape, double end, double spacing, std::size_t count,
                                 About about) {
  std::vector<double> depth(count);
  constexpr int samples = 400;
  for (std::size_t i = 0; i < count; ++i) {
    double sum = 0.0, area = 0.0;
    for (int k = 0; k < samples; ++k) {
      const double place = (static_cast<double>(i) + (k + 0.5) / samples) * spacing;
      const double weight = about == About::axis ? place : 1.0;
      sum += weight * shape(place, end);
      area += weight;
    }
    depth[i] = sum / area;
  }
  return depth;
}

/// The same as particles two a ring, the first column of them at an offset: each stands at the middle of what it
/// holds.
std::vector<double> as_particles(const Shape& shape, double end, double spacing, std::size_t count,
                                 About about, double offset) {
  const double width = 0.5 * spacing, extent = static_cast<double>(count) * spacing;
  DepthAccumulator rings(about, spacing, extent, width);
  for (double from = (offset - 1.0) * width; from < extent - width; from += width) {
    constexpr int samples = 200;
    const double low = std::max(0.0, from), step = (from + width - low) / samples;
    double volume = 0.0, moment = 0.0;
    for (int k = 0; k < samples && step > 0.0; ++k) {
      const double place = low + (k + 0.5) * step;
      const double held = shape(place, end) * (about == About::axis ? 2.0 * M_PI * place : 1.0) * step;
      volume += held;
      moment += place * held;
    }
    if (volume > 0.0) rings.add(moment / volume, volume);
  }
  return rings.depth();
}

std::vector<double> centres(double spacing, std::size_t count) {
  std::vector<double> centre(count);
  for (std::size_t i = 0; i < count; ++i) centre[i] = (static_cast<double>(i) + 0.5) * spacing;
  return centre;
}

double exact_edge(const Shape& shape, double end, double threshold) {
  double deep = 0.5 * end, shallow = end * (1.0 + 1e-12);
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (deep + shallow);
    (shape(middle, end) > threshold ? deep : shallow) = middle;
  }
  return deep;
}

double abrams_cone(double r, double) { return r < 0.05 ? 0.3 : std::max(0.0, 6.0 * (0.1 - r)); }

/// Arrested, tau0 / (rho g) = 2.04 mm as in Roussel's slump; four times that; a viscous current; a wall; flanks.
struct Known {
  std::string name;
  Shape shape;
};
const std::vector<Known> known_noses = {
    {"arrested", [](double r, double end) { return r < end ? std::sqrt(2.0 * 2.04e-3 * (end - r)) : 0.0; }},
    {"stiff", [](double r, double end) { return r < end ? std::sqrt(2.0 * 8.16e-3 * (end - r)) : 0.0; }},
    {"viscous",
     [](double r, double end) { return r < end ? 0.05 * std::cbrt(1.0 - r * r / (end * end)) : 0.0; }},
    {"wall", [](double r, double end) { return r < end ? 0.06 : 0.0; }},
    {"cone", [](double r, double end) { return r < end ? std::min(0.3, 6.0 * (end - r)) : 0.0; }},
    {"slope", [](double r, double end) { return r < end ? std::min(0.3, end - r) : 0.0; }}};

/// Fronts that are none of the noses: a rounded step, one with a tail, one that bulges.
const std::vector<Known> other_fronts = {
    {"rounded",
     [](double r, double end) { return r < end ? 0.06 * (1.0 - std::exp((r - end) / 0.008)) : 0.0; }},
    {"tail",
     [](double r, double end) {
       return r < end ? 0.06 * (1.0 - std::exp(-std::pow((end - r) / 0.012, 2))) : 0.0;
     }},
    {"bulge", [](double r, double end) {
       return r < end ? 0.05 * std::sqrt(std::min(1.0, (end - r) / 0.02)) * (1.0 + 0.3 * r / end) : 0.0;
     }}};

/// Reads a front at many places; gives the largest error in cells, and how far a reading falls behind the one
/// before.
struct Found {
  double worst = 0.0, back = 0.0;
};
Found read_advancing(const Known& known, double spacing, About about, bool particles, double threshold,
                     double offset) {
  const auto count = static_cast<std::size_t>(0.5 / spacing);
  const auto centre = centres(spacing, count);
  Found found;
  double before = 0.0;
  for (double end = 0.2; end < 0.2 + 3.0 * spacing; end += spacing / 23.0) {
    const auto depth = particles ? as_particles(known.shape, end, spacing, count, about, offset)
                                 : as_fractions(known.shape, end, spacing, count, about);
    const double edge = edge_of_depth({centre, depth, about}, threshold);
    const double error = std::abs(edge - exact_edge(known.shape, end, threshold)) / spacing;
    found.worst = std::max(found.worst, error);
    found.back = std::max(found.back, (before - edge) / spacing);
    before = edge;
  }
  return found;
}

}  // namespace

TEST(Nose, TheConeBeforeItMovesIs199MillimetresWideOnAnyCells) {
  for (const double spacing : {0.02, 0.01, 0.005}) {
    const auto count = static_cast<std::size_t>(0.3 / spacing);
    const auto depth = as_fractions(abrams_cone, 0.0, spacing, count, About::axis);
    EXPECT_NEAR(1e3 * spread({centres(spacing, count), depth}, 0.003), 199.0, 0.02) << spacing;
  }
}

TEST(Nose, KnownFrontsAsFractionsAreReadToAThirtiethOfACellAndNeverStepBack) {
  for (const About about : {About::axis, About::plane})
    for (const double spacing : {0.02, 0.01, 0.005})
      for (const Known& known : known_noses)
        for (const double threshold : {0.0015, 0.003, 0.006}) {
          const Found found = read_advancing(known, spacing, about, false, threshold, 0.0);
          EXPECT_LT(found.worst, 0.03) << known.name << " " << spacing << " at " << threshold;
          EXPECT_LT(found.back, 1e-6) << known.name << " " << spacing << " at " << threshold;
        }
}

TEST(Nose, KnownFrontsAsParticlesAtRandomOffsetsAreReadToATenthOfACellAndNeverStepBack) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> offset(0.0, 1.0);
  for (const About about : {About::axis, About::plane})
    for (const double spacing : {0.02, 0.01, 0.005})
      for (const Known& known : known_noses)
        for (int repeat = 0; repeat < 3; ++repeat) {
          const Found found = read_advancing(known, spacing, about, true, 0.003, offset(random));
          EXPECT_LT(found.worst, 0.1) << known.name << " " << spacing;
          EXPECT_LT(found.back, 2e-3) << known.name << " " << spacing;
        }
}

TEST(Nose, OtherFrontsAreReadWithinHalfACellAndNeverStepBack) {
  for (const About about : {About::axis, About::plane})
    for (const double spacing : {0.02, 0.01, 0.005})
      for (const Known& known : other_fronts) {
        const Found found = read_advancing(known, spacing, about, false, 0.003, 0.0);
        EXPECT_LT(found.worst, 0.45) << known.name << " " << spacing;
        EXPECT_LT(found.back, 2e-3) << known.name << " " << spacing;
      }
}

TEST(Nose, AThresholdMovesTheEdgeTheRightWay) {
  const auto centre = centres(0.01, 50);
  for (const Known& known : known_noses) {
    const auto depth = as_fractions(known.shape, 0.2137, 0.01, 50, About::axis);
    EXPECT_LE(spread({centre, depth}, 0.006), spread({centre, depth}, 0.003)) << known.name;
    EXPECT_LE(spread({centre, depth}, 0.003), spread({centre, depth}, 0.0015)) << known.name;
  }
}

TEST(Nose, FineRingsAreReadAsACurveIs) {
  // h = 0.036 sqrt(1 - r/0.3): falls through t at r = 0.3 (1 - (t/0.036)^2).
  const auto centre = centres(1e-4, 4000);
  std::vector<double> depth;
  for (const double r : centre) depth.push_back(r < 0.3 ? 0.036 * std::sqrt(1.0 - r / 0.3) : 0.0);
  for (const double threshold : {0.0015, 0.003, 0.006})
    EXPECT_NEAR(spread({centre, depth}, threshold), 0.6 * (1.0 - std::pow(threshold / 0.036, 2)), 2e-4)
        << "threshold " << threshold;
}

TEST(Nose, ADetachedRingCountsAndABumpStandsAsAWall) {
  const std::vector<double> centre = {0.5, 1.5, 2.5, 3.5};
  // As much as a ring of 5 mm, as deep as it is seen to be: up to the ring's outer edge.
  EXPECT_NEAR(edge_of_depth({centre, std::vector{0.010, 0.001, 0.005, 0.0}, About::plane}, 0.003), 3.0,
              1e-12);
  EXPECT_NEAR(edge_of_depth({centre, std::vector{0.010, 0.001, 0.005, 0.001}, About::plane}, 0.003),
              3.0 + 0.2, 0.8);
  EXPECT_DOUBLE_EQ(edge_of_depth({centre, std::vector{0.010, 0.010, 0.010, 0.010}, About::plane}, 0.003), 4.0)
      << "deeper than the threshold up to where rings end";
  EXPECT_NEAR(edge_of_depth({centre, std::vector{0.010, 0.0, 0.0, 0.0}, About::plane}, 0.003), 1.0, 1e-12);
}

TEST(Nose, NothingIsReadWhereNothingIsDeepEnough) {
  const std::vector<double> centre = {0.5, 1.5, 2.5}, thin = {0.002, 0.002, 0.001};
  EXPECT_TRUE(std::isnan(edge_of_depth({centre, thin}, 0.003)));
  EXPECT_TRUE(std::isnan(edge_of_depth({}, 0.003)));
}
