#include "tests/batch/slurm_cluster.h"

#include <signal.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <thread>

#include "tests/batch/batch_folder.h"

namespace mdk::test {
namespace {

constexpr const char* kConfiguration = R"(ClusterName=mdk
SlurmctldHost=HOST
SlurmUser=root
SlurmdUser=root
SlurmctldPort=26817
SlurmdPort=26818
SchedulerParameters=batch_sched_delay=0,sched_interval=1
AuthType=auth/munge
AuthInfo=socket=FOLDER/munge.socket
CredType=cred/munge
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
ReturnToService=2
MpiDefault=none
StateSaveLocation=FOLDER/state
SlurmdSpoolDir=FOLDER/spool
SlurmctldLogFile=FOLDER/slurmctld.log
SlurmdLogFile=FOLDER/slurmd.log
SlurmctldPidFile=FOLDER/slurmctld.pid
SlurmdPidFile=FOLDER/slurmd.pid
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
NodeName=HOST CPUs=2 RealMemory=6000 State=UNKNOWN
PartitionName=main Nodes=HOST Default=YES MaxTime=INFINITE State=UP
)";

std::string with(std::string text, const std::string& word, const std::string& value) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at)) {
    text.replace(at, word.size(), value);
    at += value.size();
  }
  return text;
}

bool run(const std::string& line) {
  return std::system(("(" + line + ") > /dev/null 2>&1 < /dev/null").c_str()) == 0;
}

}  // namespace

SlurmCluster::SlurmCluster() : trouble_(start()) {}

std::string SlurmCluster::start() {
  for (const char* program : {"munged", "slurmctld", "slurmd", "sbatch", "scontrol"})
    if (!has_program(program)) return std::string("there is no ") + program;
  if (geteuid() != 0) return "only root can start slurmd";
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  const std::string name = std::string(host.data()).substr(0, std::string(host.data()).find('.'));
  const std::string folder = folder_.path();
  write_text(folder_.file("slurm.conf"),
             with(with(kConfiguration, "HOST", name), "FOLDER", folder));
  write_text(folder_.file("munge.key"), std::string(1024, 'k'));
  run("cd '" + folder + "' && mkdir state spool && chmod 0755 . && chmod 0400 munge.key");
  if (!run("munged --force --key-file='" + folder + "/munge.key' --socket='" + folder +
           "/munge.socket' --pid-file='" + folder + "/munged.pid' --log-file='" + folder +
           "/munged.log' --seed-file='" + folder + "/munge.seed'"))
    return "munged does not start";
  if (!run(environment() + " slurmctld")) return "slurmctld does not start";
  if (!run(environment() + " slurmd")) return "slurmd does not start";
  for (int i = 0; i < 100; ++i) {
    if (run(environment() + " sinfo --noheader --states=idle | grep -q idle")) return "";
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }
  return "the node does not become idle";
}

SlurmCluster::~SlurmCluster() {
  if (trouble_.empty()) run(environment() + " scancel --user=root");
  for (const char* name : {"slurmd.pid", "slurmctld.pid", "munged.pid"}) {
    std::ifstream file(folder_.file(name));
    pid_t process = 0;
    if (!(file >> process) || process <= 1) continue;
    kill(process, SIGTERM);
    for (int i = 0; i < 50 && kill(process, 0) == 0; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

}  // namespace mdk::test
