// SPDX-License-Identifier: BSD-3-Clause
//
// The command line: options and help.
#include <fcl/config.h>
#include <fcntl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <limits>
#include <map>
#include <string>

#include "fcl/ccd_version.h"
#include "output_file.h"
#include "queries_command.h"
#include "run_command.h"
#include "run_inputs.h"
#include "stop_signal.h"

namespace {

using fcl::ContinuousContactKind;
using fcl::ContinuousQuery;

constexpr const char* kMainExamples = R"(Examples:
  fcl-ccd run cloth_0.ply cloth_1.ply
  fcl-ccd run frames/ --against body.obj --contacts contacts.csv --steps steps.jsonl
  fcl-ccd queries edge-edge.csv --kind ee --json errors.json

'fcl-ccd COMMAND --help' tells more. Exit code: 0 when done, with or without contacts;
2 when refused, in which case no output file is written or changed; 3 and above when
stopped on the way ('fcl-ccd run --help').)";

constexpr const char* kRunDetails = R"(Frames:
  A file, a folder (its meshes, f9 before f10), a pattern in quotes ('frames/*.ply') or a
  name with a number (frame_%04d.ply). --start, --end and --stride select from the last
  three: numbers of %04d, places from 0 otherwise. All frames of a mesh have the same
  vertices and faces in the same order. Read are OBJ, PLY (ascii and binary, float and
  double), OFF (text) and STL (both kinds). Polygons are divided into triangles as they
  are in the first frame: convex ones into the fan around their first vertex. All files
  are checked before the first step; of binary PLY, all but the positions.
  Step i goes from frame i to frame i + 1, counted from 0; vertices move on straight lines.

What is tested:
  Without --against: A against itself. With --against: A against itself and A against B,
  never B against itself; --no-self leaves A against B. One frame of B: it stands still.
  A mesh in which no triangle shares a vertex has contacts between all neighbours: --weld
  joins vertices that coincide in all frames; ids stay those of the file.

Output:
  A contact counts as vf (vertex-face) or ee (edge-edge); each is proved, so that the
  table's 'uncertain' is 0. 'vertices' and 'triangles' count those of all meshes. With
  '--query first' the contacts are those that may be the first, with '--query any'
  at most one, not always the earliest.
  --contacts: step,kind,i0,i1,i2,i3,toc_lo,toc_hi with kind vf (vertex, face) or ee (edge
  a, edge b); ids count from 0, those of B are prefixed b; the first time of contact lies
  in [toc_lo, toc_hi], in fractions of the step. --columns adds t0,t1 (the triangles of
  both features), x,y,z (where they touch) and nx,ny,nz (normal, from A to B).
  --steps: JSON lines: the options, one object a step, a summary when all is done.
  --json: all steps with times in milliseconds; build: the hierarchy, in the first step of
  each job; total = update + traverse + test.
  --paint: vertices of vf contacts red, of ee contacts orange, of the edge and face that
  cross at t = 0 violet; B's vertices follow A's.
  --contacts and --steps grow with each step. --json and --paint appear at the end.

Stopping:
  Ctrl-C, SIGTERM and SIGHUP let the steps that are in work finish; a second one does not.
  --resume goes on behind the last whole step of the files of --contacts and --steps,
  which then are as if the run had never stopped.
  Exit code: 0 done; 2 refused, no file written or changed; 3 a frame on the way cannot be
  read or used; 4 an output cannot be written (disk full); 128 + N stopped by signal N.
  After 3, 4 and 128 + N the files have all steps that were done.

Cores:
  By default as many steps side by side as there are cores; with --repeat or --threads one
  after the other, so that times are those of a step that has the machine to itself. The
  output is the same.

Examples:
  fcl-ccd run cloth_0.ply cloth_1.ply cloth_2.ply --json times.json --repeat 5
  fcl-ccd run cloth_0.ply cloth_1.ply --query first
  fcl-ccd run frames/ --against body.obj --contacts contacts.csv --steps steps.jsonl
  fcl-ccd run frames/ --against body.obj --contacts contacts.csv --steps steps.jsonl --resume
  fcl-ccd run frame_%04d.ply --start 100 --end 199 --contacts contacts.csv
  fcl-ccd run --against ball_0.obj ball_1.obj --no-self -- cloth_0.obj cloth_1.obj
  fcl-ccd run cloth_0.ply cloth_1.ply --contacts contacts.csv --paint contacts.ply)";

constexpr const char* kQueriesDetails = R"(Input:
  Eight rows a query: the four points at t = 0, then at t = 1; vertex, face or edge a,
  edge b. A row is num,den,num,den,num,den (x, y, z as fractions of integers of any size)
  and optionally 0 or 1, whether the features truly touch. Coordinates become the nearest
  double.

Output:
  --print: index,answer,toc_lo,toc_hi with answer yes, no or unsure, instead of the table.
  --json: false_positives counts answers 'yes' (not 'unsure') that are wrong; what needs
  the truth is null without it.

Examples:
  fcl-ccd queries vertex-face.csv --kind vf
  fcl-ccd queries a/edge-edge.csv b/edge-edge.csv --kind ee --repeat 10 --json errors.json
  fcl-ccd queries edge-edge.csv --kind ee --print > answers.csv)";

/// @brief A validator that takes finite numbers of a type that are more than 0. (CLI11's
/// own lets inf through, and answers a word with the range of double.)
template <typename Number>
CLI::Validator positive(const char* what) {
  return {[what](std::string& text) {
            Number value = 0;
            const bool valid = CLI::detail::lexical_cast(text, value) && value > 0 &&
                               value <= std::numeric_limits<Number>::max();
            return valid ? std::string() : "'" + text + "' is not " + what;
          },
          ""};
}

/// @brief A validator that takes finite numbers of a type from 0.
template <typename Number>
CLI::Validator notNegative(const char* what) {
  return {[what](std::string& text) {
            Number value = -1;
            const bool valid = CLI::detail::lexical_cast(text, value) && value >= 0 &&
                               value <= std::numeric_limits<Number>::max();
            return valid ? std::string() : "'" + text + "' is not " + what;
          },
          ""};
}

/// @brief A validator that takes the names of a map and hands on their values.
template <typename Value>
CLI::Validator oneOf(const std::map<std::string, Value>& names, const char* what) {
  return {[&names, what](std::string& text) {
            const auto found = names.find(text);
            if (found == names.end()) return "'" + text + "' is not " + what;
            text = std::to_string(static_cast<int>(found->second));
            return std::string();
          },
          ""};
}

/// @brief A validator of files to be written.
CLI::Validator named() {
  return {[](const std::string& text) {
            return text.empty() ? "no file is named" : std::string();
          },
          ""};
}

void addCommonOptions(CLI::App& command, double& toc_err, int& repeat,
                      std::string& json_path) {
  command.add_option("--toc-err", toc_err, "Width of a contact's time bracket")
      ->type_name("X")
      ->check(positive<double>("a positive number"))
      ->capture_default_str();
  command.add_option("--repeat", repeat, "Do everything N times, report the least time")
      ->type_name("N")
      ->check(positive<int>("a positive whole number"))
      ->capture_default_str();
  command.add_option("--json", json_path, "Write the results as JSON")
      ->type_name("FILE")
      ->check(named());
}

/// @brief Columns from their names, with commas between them.
fcl_ccd::ContactColumns parseColumns(const std::string& list) {
  fcl_ccd::ContactColumns columns;
  const std::map<std::string, bool*> names{{"triangles", &columns.triangles},
                                           {"position", &columns.position},
                                           {"normal", &columns.normal}};
  for (const std::string& name : CLI::detail::split(list, ',')) {
    const auto found = names.find(name);
    if (found == names.end())
      throw CLI::ValidationError("--columns",
                                 "'" + name + "' is not triangles, position or normal");
    *found->second = true;
  }
  return columns;
}

CLI::App* addRun(CLI::App& app, fcl_ccd::RunOptions& options) {
  constexpr int kUnlimited = -1;
  CLI::App* run = app.add_subcommand("run", "Continuous collision of meshes in motion");
  run->footer(kRunDetails);
  run->add_option("A", options.frames, "Frames of mesh A, at least two")
      ->type_name("FRAMES")
      ->required()
      ->expected(1, kUnlimited);
  run->add_option("--against", options.against,
                  "Frames of mesh B, as many as of A or one")
      ->type_name("FRAMES")
      ->expected(1, kUnlimited);
  run->add_option("--start", options.range.start, "First frame")->type_name("N");
  run->add_option("--end", options.range.end, "Last frame")->type_name("N");
  run->add_option("--stride", options.range.stride, "Every so many frames")
      ->type_name("N")
      ->check(positive<int>("a positive whole number"))
      ->capture_default_str();
  run->add_flag_callback(
         "--no-self", [&options] { options.settings.self = false; },
         "Do not test A against itself")
      ->needs("--against");
  static const std::map<std::string, ContinuousQuery> kQueries{
      {"all", ContinuousQuery::kAll},
      {"first", ContinuousQuery::kFirst},
      {"any", ContinuousQuery::kAny}};
  run->add_option("--query", options.settings.query, "all, first or any (default: all)")
      ->type_name("WHAT")
      ->transform(oneOf(kQueries, "all, first or any"));
  run->add_option("--jobs", options.jobs,
                  "Steps side by side, one thread each; 0: as many as there are cores")
      ->type_name("N")
      ->check(notNegative<int>("a number of jobs"));
  run->add_option(
         "--threads", options.threads,
         "Threads of a build, an update or a query; 0: as many as there are cores")
      ->type_name("N")
      ->check(notNegative<int>("a number of threads"));
  run->add_option("--weld", options.weld,
                  "Join vertices that coincide in all frames, up to EPS (default: 0)")
      ->type_name("[EPS]")
      ->expected(0, 1)
      ->default_str("0")
      ->check(notNegative<double>("a distance"));
  run->add_option("--contacts", options.contacts_path, "Write the contacts as CSV")
      ->type_name("FILE")
      ->check(named());
  run->add_option_function<std::string>(
         "--columns",
         [&options](const std::string& list) { options.columns = parseColumns(list); },
         "More columns: triangles,position,normal")
      ->type_name("LIST")
      ->needs("--contacts");
  run->add_option("--steps", options.steps_path,
                  "Write a JSON object a step, as it comes")
      ->type_name("FILE")
      ->check(named());
  run->add_flag("--resume", options.resume,
                "Go on where --contacts and --steps were left");
  run->add_option("--paint", options.paint_path,
                  "Write the last frame as PLY, contacts in colour")
      ->type_name("FILE")
      ->check(named());
  addCommonOptions(*run, options.settings.toc_err, options.settings.repeat,
                   options.json_path);
  return run;
}

CLI::App* addQueries(CLI::App& app, fcl_ccd::QueriesOptions& options) {
  CLI::App* queries =
      app.add_subcommand("queries", "Elementary vertex-face or edge-edge queries");
  queries->footer(kQueriesDetails);
  queries->add_option("FILES", options.files, "CSV files of queries")
      ->type_name("FILE")
      ->required();
  static const std::map<std::string, ContinuousContactKind> kKinds{
      {"vf", ContinuousContactKind::kVertexFace},
      {"ee", ContinuousContactKind::kEdgeEdge}};
  queries->add_option("--kind", options.kind, "vf (vertex-face) or ee (edge-edge)")
      ->type_name("KIND")
      ->required()
      ->transform(oneOf(kKinds, "vf or ee"));
  queries->add_flag("--print", options.print_answers, "One line a query on stdout");
  addCommonOptions(*queries, options.toc_err, options.repeat, options.json_path);
  return queries;
}

/// Gives standard streams that are closed to what cannot be written to: else a file that
/// is opened would take the place of one, and the table be written into it.
void occupyStandardStreams() {
  int file;
  do file = open("/dev/null", O_RDONLY);
  while (file >= 0 && file <= STDERR_FILENO);
  if (file >= 0) close(file);
}

int reportFailure(const char* what) {
  std::fprintf(stderr, "fcl-ccd: %s\n", what);
  return fcl_ccd::kRefused;
}

}  // namespace

int main(int argc, char** argv) try {
  occupyStandardStreams();
  CLI::App app("Continuous collision detection for triangle meshes that deform");
  app.name("fcl-ccd");
  app.footer(kMainExamples);
  app.set_version_flag("--version", "fcl-ccd " FCL_CCD_VERSION " (FCL " FCL_VERSION ")");
  app.require_subcommand(1);
  fcl_ccd::RunOptions run_options;
  fcl_ccd::QueriesOptions queries_options;
  const CLI::App* run = addRun(app, run_options);
  addQueries(app, queries_options);
  try {
    app.parse(argc, argv);
    if (run_options.resume && run_options.contacts_path.empty() &&
        run_options.steps_path.empty())
      throw CLI::ValidationError("--resume", "needs --contacts or --steps to go on with");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : fcl_ccd::kRefused;
  }

  if (run->parsed()) {
    fcl_ccd::catchStopSignals();
    return fcl_ccd::runCommand(run_options);
  }
  fcl_ccd::removeTemporariesOnSignal();
  fcl_ccd::queriesCommand(queries_options);
  return 0;
} catch (const fcl_ccd::StoppedBySignal& stopped) {
  reportFailure(stopped.what());
  return fcl_ccd::kSignalled + fcl_ccd::stopSignal();
} catch (const std::bad_alloc&) {
  return reportFailure("out of memory");
} catch (const std::exception& error) {
  return reportFailure(error.what());
}
