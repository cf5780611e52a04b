#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studies/job.h"
#include "studies/study.h"

/// The runs of a study as jobs of a Snakemake workflow.
namespace flowrest::studies {

struct WorkflowOptions {
  int cores = 0;                  ///< 0: all
  std::string profile;            ///< of Snakemake, a folder; empty: this machine
  std::vector<std::string> more;  ///< handed to Snakemake as they are
  bool quiet = false;
};

/// @throws runs::RunError where the folder has a name under which the profile's jobs would not be found.
void check_folder(const Folder&, const WorkflowOptions&);

/// Writes what is to be run: jobs.json, a scene for every job, the Snakefile; and takes away every mark whose
/// run does not stand up to it. @return the jobs still to be made.
std::size_t prepare(const Folder&, const Study&, const std::vector<Point>&);

/// Makes the runs that are missing. @return 0; 130 where interrupted; 5 where the machine failed, as on a
/// full disk; 1 where some could not be made for another reason.
/// @throws runs::MissingProgram where Snakemake is not installed.
int run_workflow(const Folder&, const Study&, const std::vector<Point>&, const WorkflowOptions&);

}  // namespace flowrest::studies
