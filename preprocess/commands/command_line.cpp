#include "preprocess/commands/command_line.h"

#include "preprocess/tool/text.h"

namespace mdk {

Command mdprep_command() {
  Command mdprep("mdprep",
                 "mdprep prepares animated meshes for ray tracing, and renders and measures them.");
  mdprep.set_version("mdprep " + version_text(tool_version()));
  mdprep.set_notes(
      "Exit status: 0 done, 1 internal fault (please report), 2 wrong use, 3 bad input,\n"
      "4 cannot read or write, 5 over a limit.\n"
      "Messages go to stderr, data to stdout. 'mdprep SUBCOMMAND --help' tells more.");
  add_bake_command(mdprep.add_subcommand(
      "bake", "Read an animated mesh and write one .mdk file that is all a renderer needs."));
  add_scene_command(mdprep.add_subcommand(
      "scene", "Make a .mds scene: many instances of .mdk models, each at its own time."));
  add_info_command(mdprep.add_subcommand("info", "Show what is inside a .mdk file."));
  add_verify_command(mdprep.add_subcommand(
      "verify",
      "Check a .mdk file: checksums, links, boxes at keys and between, and that every\n"
      "technique gives brute force's hits. Exit status 3 where a check fails."));
  add_render_command(
      mdprep.add_subcommand("render", "Ray trace frames of a .mdk file to PNG; needs no display."));
  add_bench_command(mdprep.add_subcommand("bench", "Time the techniques on .mdk files."));
  add_batch_command(mdprep.add_subcommand(
      "batch", "Turn a list of bakes, verifies and renders into jobs for ninja, make or Slurm."));
  add_job_command(mdprep.add_subcommand(
      "job", "Run one job of a batch where it is needed, and keep a record of it."));
  return mdprep;
}

}  // namespace mdk
