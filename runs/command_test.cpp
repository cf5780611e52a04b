#include "runs/command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>

#include "runs/temporary_folder.h"

using namespace flowrest;
using namespace flowrest::runs;
namespace fs = std::filesystem;
using testing::ElementsAre;

namespace {

/// What a POSIX shell prints.
std::string printed_by_shell(const std::string& command) {
  std::FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  std::array<char, 256> part{};
  while (const std::size_t n = std::fread(part.data(), 1, part.size(), pipe)) text.append(part.data(), n);
  pclose(pipe);
  return text;
}

}  // namespace

TEST(ShellWord, ComesOutOfAShellAsItWentIn) {
  for (const std::string text :
       {"roussel-slump", "", "my runs/a b", "it's", "\"quoted\"", "$HOME", "`date`", "a\\b", "a;b", "#1", "~",
        "*", "a\nb", "mix (2)", "Beton ü", "mpm.particles_per_cell=[3, 3]", "!x", "{a,b}", "a&b|c>d"})
    EXPECT_EQ(printed_by_shell("printf %s " + shell_word(text)), text);
}

TEST(ShellWord, LeavesPlainWordsAlone) {
  for (const std::string text : {"roussel-slump", "--set", "mpm.cell=0.01", "out/a_b/c", "5%"})
    EXPECT_EQ(shell_word(text), text);
}

TEST(CommandLine, QuotesWhatAShellWouldReadOtherwise) {
  EXPECT_EQ(command_line({"mpm", "--resume", "out/my run"}), "flowrest mpm --resume 'out/my run'");
  EXPECT_EQ(path_argument("-odd"), "./-odd") << "no option";
}

class RequestTest : public testing::Test {
 protected:
  RequestTest() {
    fs::create_directory(folder / "my scenes");
    std::ofstream(folder / "my scenes" / "it's.toml") << "extends = \"roussel-slump\"\ntitle = \"Mine\"\n";
  }
  TemporaryFolder temporary;
  fs::path folder = temporary.path();
};

TEST_F(RequestTest, CarriesEverySettingAndTheModelThroughRunJson) {
  const auto scene =
      scenes::load_scene("roussel-slump", {{"mpm.cell=0.02", "title=a b"}, scenes::Model::bi_viscous});
  const auto request = request_of({{"request", request_json(scene.request)}});
  ASSERT_TRUE(request);
  EXPECT_THAT(scene_arguments(*request), ElementsAre("roussel-slump", "--model", "bi-viscous", "--set",
                                                     "mpm.cell=0.02", "--set", "title=a b"));
  EXPECT_THAT(scene_arguments(*request, "papanastasiou"),
              ElementsAre("roussel-slump", "--model", "papanastasiou", "--set", "mpm.cell=0.02", "--set",
                          "title=a b"));
}

TEST_F(RequestTest, AModelThatIsNamedTakesThePlaceOfOneThatIsSet) {
  const auto scene =
      scenes::load_scene("roussel-slump", {{" material.model = papanastasiou", "mpm.cfl=0.5"}, {}});
  EXPECT_THAT(
      scene_arguments(scene.request),
      ElementsAre("roussel-slump", "--set", " material.model = papanastasiou", "--set", "mpm.cfl=0.5"));
  EXPECT_THAT(scene_arguments(scene.request, "bi-viscous"),
              ElementsAre("roussel-slump", "--model", "bi-viscous", "--set", "mpm.cfl=0.5"));
}

TEST_F(RequestTest, APathStaysAsItWasGivenWhereItLeadsThereAndIsGivenInFullElsewhere) {
  const fs::path file = folder / "my scenes" / "it's.toml";
  const fs::path before = fs::current_path();
  fs::current_path(folder);
  const auto scene = scenes::load_scene("my scenes/it's.toml");
  EXPECT_THAT(scene_arguments(scene.request), ElementsAre("my scenes/it's.toml"));
  const auto command = command_to_make({{"request", request_json(scene.request)}, {"scene_name", scene.name}},
                                       "foam", "papanastasiou");
  EXPECT_EQ(command.value_or(""), "flowrest foam 'my scenes/it'\\''s.toml' --model papanastasiou");
  fs::current_path(before);
  EXPECT_THAT(scene_arguments(scene.request), ElementsAre(fs::weakly_canonical(file).string()));
}

TEST_F(RequestTest, ACommandWritesWhereNothingLies) {
  const fs::path before = fs::current_path();
  fs::current_path(folder);
  fs::create_directories("out/roussel-slump/mpm-papanastasiou");
  const auto scene = scenes::load_scene("roussel-slump");
  EXPECT_EQ(command_to_make({{"request", request_json(scene.request)}, {"scene_name", scene.name}}, "mpm",
                            "papanastasiou")
                .value_or(""),
            "flowrest mpm roussel-slump --model papanastasiou -o out/roussel-slump/mpm-papanastasiou-2");
  fs::current_path(before);
}

TEST_F(RequestTest, ARunThatDoesNotSayWhichSceneItWasHasNoCommand) {
  EXPECT_FALSE(command_to_make({{"title", "measured"}}, "mpm", "papanastasiou"));
  EXPECT_FALSE(command_to_make({{"scene_name", "no-such-scene"}}, "mpm", "papanastasiou"));
  EXPECT_TRUE(command_to_make({{"scene_name", "roussel-slump"}}, "mpm", "papanastasiou"))
      << "runs of old say the name alone";
}
