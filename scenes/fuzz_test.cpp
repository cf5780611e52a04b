#include <chrono>
#include <cstdlib>
#include <iostream>
#include <random>

#include "scenes/summary.h"
#include "scenes/test_scenes.h"

/// Mutated scenes and settings: whatever is thrown at the reader, it gives a scene or a SceneError, and soon.
namespace flowrest::scenes::test {
namespace {

using Clock = std::chrono::steady_clock;

/// Changes texts by chance, the same way for the same seed.
class Mutator {
 public:
  explicit Mutator(std::uint64_t seed) : random_(seed) {}

  std::string mutated(std::string text) {
    const int changes = 1 + below(4);
    for (int i = 0; i < changes; ++i) change(text);
    return text;
  }

  std::string setting() {
    static const std::vector<std::string> paths = {"mpm.cell",
                                                   "mpm.particles_per_cell",
                                                   "material.density",
                                                   "runs.mpm",
                                                   "forces.body_force",
                                                   "geometry.dimension",
                                                   "kind",
                                                   "title",
                                                   "thixotropy.flocculation_rate",
                                                   "walls.base",
                                                   "mpm",
                                                   "mpm.seed",
                                                   "time.end",
                                                   "extends"};
    return mutated(paths[below(std::ssize(paths))] + "=" + token());
  }

  int below(std::ptrdiff_t limit) { return static_cast<int>(random_() % static_cast<std::uint64_t>(limit)); }

 private:
  std::size_t place_in(const std::string& text) { return text.empty() ? 0 : random_() % text.size(); }

  /// What tends to upset readers: extremes of numbers, punctuation, nesting, strings, odd characters.
  std::string token() {
    static const std::vector<std::string> tokens = {"nan",
                                                    "inf",
                                                    "-inf",
                                                    "1e308",
                                                    "-1e308",
                                                    "1e-308",
                                                    "5e-324",
                                                    "0",
                                                    "-0.0",
                                                    "1e400",
                                                    "9223372036854775807",
                                                    "-9223372036854775808",
                                                    "9223372036854775808",
                                                    "0x7fffffffffffffff",
                                                    "0b1",
                                                    "0o7",
                                                    "1_000",
                                                    "1e",
                                                    ".5",
                                                    "5.",
                                                    "true",
                                                    "false",
                                                    "[",
                                                    "]",
                                                    "[[",
                                                    "]]",
                                                    "{",
                                                    "}",
                                                    "=",
                                                    ",",
                                                    ".",
                                                    "#",
                                                    "\n",
                                                    "\r",
                                                    "\r\n",
                                                    "\t",
                                                    "\"",
                                                    "'",
                                                    "\"\"\"",
                                                    "'''",
                                                    "\\",
                                                    "\\u0000",
                                                    "\\U0010FFFF",
                                                    "\\uD800",
                                                    "[[0.0, 1.0]]",
                                                    "[3, 3, 3]",
                                                    "{ a = 1 }",
                                                    "1979-05-27",
                                                    "07:32:00",
                                                    "1979-05-27T07:32:00Z",
                                                    "a.b.c",
                                                    "[mpm]",
                                                    "[thixotropy]",
                                                    "[foam]",
                                                    "[material]",
                                                    "extends = \"roussel-slump\"",
                                                    "extends = \"wrong\"",
                                                    "extends = \"/dev/null\"",
                                                    "kind = \"duct\"",
                                                    "\"newtonian\"",
                                                    "\"paper\"",
                                                    "\"quarter\"",
                                                    "cell = 1e-9",
                                                    "end = 1e300",
                                                    "cfl = 1e-300",
                                                    "particles_per_cell = 4096"};
    return tokens[random_() % tokens.size()];
  }

  static std::string nested(int depth, const std::string& opening) {
    std::string text;
    for (int i = 0; i < depth; ++i) text += opening;
    return text;
  }

  void change(std::string& text) {
    const std::size_t at = place_in(text);
    switch (below(12)) {
      case 0:
        flip_bits(text, at);
        break;
      case 1:
        text.insert(at, 1, static_cast<char>(below(256)));
        break;
      case 2:
        text.insert(at, token());
        break;
      case 3:
        text.erase(at, 1 + random_() % 20);
        break;
      case 4:
        text.resize(at);
        break;
      case 5:
        text.insert(at, text.substr(place_in(text), random_() % 200));
        break;
      case 6:
        replace_number(text, at);
        break;
      case 7:
        swap_lines(text);
        break;
      case 8:
        text += token() + " = " + token() + "\n";
        break;
      case 9:
        if (below(50) == 0)
          text.insert(at, std::string(random_() % 300000, static_cast<char>('a' + below(26))));
        break;
      case 10:
        if (below(20) == 0) text.insert(at, nested(below(2000), below(2) ? "[" : "{a="));
        break;
      case 11:
        if (below(20) == 0) text.insert(at, nested(below(20000), below(2) ? "a." : "\"=\"."));
        break;
      default:
        break;
    }
  }

  void flip_bits(std::string& text, std::size_t at) {
    if (!text.empty()) text[at] = static_cast<char>(text[at] ^ (1 << below(8)));
  }

  void replace_number(std::string& text, std::size_t at) {
    const std::size_t first = text.find_first_of("0123456789", at);
    if (first == std::string::npos) return;
    const std::size_t last = text.find_first_not_of("0123456789.e+-_", first);
    text.replace(first, (last == std::string::npos ? text.size() : last) - first, token());
  }

  void swap_lines(std::string& text) {
    const std::size_t from = text.find('\n', place_in(text));
    if (from == std::string::npos) return;
    const std::size_t to = text.find('\n', from + 1);
    if (to == std::string::npos) return;
    const std::string line = text.substr(from, to - from);
    text.erase(from, to - from);
    text.insert(std::min(text.size(), place_in(text)), line);
  }

  std::mt19937_64 random_;
};

struct Tally {
  long scenes = 0;
  long refusals = 0;
  double slowest = 0.0;  ///< s
};

std::optional<Scene> read(const std::string& text, const Overrides& overrides) {
  try {
    return parse_scene(text, "fuzzed.toml", overrides);
  } catch (const SceneError& error) {
    EXPECT_NE(std::string(error.what()), "");
    EXPECT_LT(std::string(error.what()).size(), 100000u);
    return std::nullopt;
  }
}

void read_once(const std::string& text, const Overrides& overrides, Tally& tally) {
  const auto start = Clock::now();
  const std::optional<Scene> scene = read(text, overrides);
  ++(scene ? tally.scenes : tally.refusals);
  if (scene) {
    const std::string settings = resolved_toml(*scene);
    EXPECT_EQ(resolved_toml(parse_scene(settings, "again.toml")), settings);
    EXPECT_NE(check_json(*scene, {}), check_text(*scene, {}));
  }
  tally.slowest = std::max(tally.slowest, std::chrono::duration<double>(Clock::now() - start).count());
}

double seconds_to_fuzz() {
  const char* given = std::getenv("FLOWREST_FUZZ_SECONDS");
  return given ? std::atof(given) : 2.0;
}

TEST(Fuzz, TheReaderGivesASceneOrARefusalWhateverItIsGiven) {
  const auto end = Clock::now() + std::chrono::duration<double>(seconds_to_fuzz());
  const std::vector<std::string> seeds = {slump_text, duct_text,
                                          resolved_toml(parse_scene(slump_text, "s.toml")),
                                          resolved_toml(parse_scene(duct_text, "d.toml"))};
  Tally tally;
  std::string text;
  try {
    for (std::uint64_t seed = 1; Clock::now() < end; ++seed) {
      Mutator mutator(seed);
      text = mutator.mutated(seeds[seed % seeds.size()]);
      Overrides overrides;
      if (mutator.below(4) == 0) overrides.set.push_back(mutator.setting());
      read_once(text, overrides, tally);
      if (HasFailure()) break;
    }
  } catch (const std::exception& error) {
    ADD_FAILURE() << error.what();
  }
  if (HasFailure()) std::cout << text << "\n";
  std::cout << tally.scenes << " scenes, " << tally.refusals << " refusals, the slowest in " << tally.slowest
            << " s\n";
  EXPECT_GT(tally.scenes, 0);
  EXPECT_GT(tally.refusals, 0);
  EXPECT_LT(tally.slowest, 5.0);
}

}  // namespace
}  // namespace flowrest::scenes::test
