#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "runs/folder_lock.h"
#include "scenes/scene.h"

namespace flowrest::runs {

/// Whether a run was made with the settings that are asked for, both as run.json has them. Neither what its
/// scene is called, which runs it names, its threads, the other solver's settings nor what only another law
/// reads makes a difference. What a scene leaves to OpenFOAM, the rows at the base (0) and the time in which
/// air rises, its run says.
bool same_settings(const std::string& solver, const nlohmann::ordered_json& made,
                   const nlohmann::ordered_json& asked);

/// Which settings differ, in words: "time.end is 1 there and 2 here, ...".
std::string settings_differ(const std::string& solver, const nlohmann::ordered_json& made,
                            const nlohmann::ordered_json& asked);

/// What stands in a folder, seen from the run that is to be written into it.
enum class Standing {
  vacant,      ///< an empty folder, or none
  foreign,     ///< something that is no run
  finished,    ///< the run itself, of the same settings and version, come to its end
  unfinished,  ///< the run itself, interrupted or killed, or ended by the machine
  failed,      ///< a run whose numerics failed, of whatever settings
  another      ///< another run that somebody may want to keep
};

/// The finished run or its part in a folder, held against what is asked for; `from`: the state that it is to
/// start from, empty for its scene's body. Reads only.
Standing standing_in(const std::filesystem::path& directory, const scenes::Scene&, const std::string& solver,
                     const std::string& from = "");

/// What a new run may take the place of, beside a run that failed.
enum class Replace {
  failed,      ///< nothing more
  unfinished,  ///< an unfinished run of the same settings
  anything     ///< whatever run stands there: what --force says
};

/// What --force does, for a command's help.
inline constexpr const char* force_help =
    "Replace whatever run stands in the folder. Without it a finished run of the same settings and version "
    "is "
    "taken as it is, a failed one is replaced, and any other is refused";

/// A folder that is ours for a run: held by this process alone, with nothing in it that the run must not take
/// the place of. Nothing is changed in it yet.
class RunFolder {
 public:
  /// `beside`: what the run is asked for besides its scene; it stands in run.json and must be the same, too.
  /// @throws RunError where somebody else writes into the folder, it is neither empty nor a run of flowrest,
  /// or it holds a run that must not be replaced: a finished one of other settings, named key by key, or of
  /// another version, or an unfinished one.
  RunFolder(const std::filesystem::path& directory, const scenes::Scene&, const std::string& solver,
            Replace = Replace::failed, nlohmann::ordered_json beside = nlohmann::ordered_json::object());
  RunFolder(FolderLock, const scenes::Scene&, const std::string& solver, Replace = Replace::failed,
            nlohmann::ordered_json beside = nlohmann::ordered_json::object());

  /// Whether the very run that is asked for stands there, come to its end: nothing is to be done.
  bool is_finished() const { return finished_; }
  /// Says so.
  std::string finished_words() const;
  /// run.json as it stands there.
  const nlohmann::ordered_json& earlier() const { return earlier_; }

 private:
  friend class RunWriter;
  FolderLock lock_;
  std::string profile_header_;
  nlohmann::ordered_json info_, earlier_;
  bool finished_ = false;
};

}  // namespace flowrest::runs
