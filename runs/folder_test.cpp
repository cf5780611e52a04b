#include "runs/folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "runs/run_directory.h"
#include "runs/temporary_folder.h"

using namespace flowrest::runs;
namespace fs = std::filesystem;

namespace {

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

bool may_be_written(const fs::path& path) {
  return (fs::status(path).permissions() & fs::perms::owner_write) != fs::perms::none;
}

TEST(CopyWritable, CopiesOfWriteProtectedFilesAndFoldersMayBeWritten) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "case" / "system");
  write_atomically(folder / "case" / "system" / "controlDict", "endTime 1;");
  write_atomically(folder / "case" / "Allrun", "#!/bin/sh");
  fs::permissions(folder / "case" / "system" / "controlDict", fs::perms::owner_read);
  fs::permissions(folder / "case" / "Allrun", fs::perms::owner_read | fs::perms::owner_exec);
  constexpr fs::perms closed = fs::perms::owner_read | fs::perms::owner_exec;
  fs::permissions(folder / "case" / "system", closed);

  for (int time = 0; time < 2; ++time) copy_writable(folder / "case", folder / "copy");

  EXPECT_EQ(text_of(folder / "copy" / "system" / "controlDict"), "endTime 1;");
  EXPECT_TRUE(may_be_written(folder / "copy" / "system"));
  EXPECT_TRUE(may_be_written(folder / "copy" / "system" / "controlDict"));
  EXPECT_TRUE((fs::status(folder / "copy" / "Allrun").permissions() & fs::perms::owner_exec) !=
              fs::perms::none);
  fs::permissions(folder / "case" / "system", fs::perms::owner_all);
}

}  // namespace
