// A Slurm cluster of one node on this machine, with munge, in a folder of its own: munged,
// slurmctld and slurmd, started and ended with it.
#pragma once

#include <string>

#include "tests/formats/temp_folder.h"

namespace mdk::test {

class SlurmCluster {
 public:
  SlurmCluster();
  ~SlurmCluster();
  SlurmCluster(const SlurmCluster&) = delete;
  SlurmCluster& operator=(const SlurmCluster&) = delete;

  /// Why there is no cluster; empty where there is one.
  const std::string& trouble() const { return trouble_; }
  /// "SLURM_CONF=…", for the environment of sbatch.
  std::string environment() const { return "SLURM_CONF='" + folder_.file("slurm.conf") + "'"; }

 private:
  std::string start();

  TempFolder folder_;
  std::string trouble_;
};

}  // namespace mdk::test
