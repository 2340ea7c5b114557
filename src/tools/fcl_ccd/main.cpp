// SPDX-License-Identifier: BSD-3-Clause
//
// The command line: options, help, exit codes. 0: done (with or without contacts).
// 2: anything else; nothing was written then.
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

namespace {

using fcl::ContinuousQuery;
using fcl::detail::deformable::FeatureKind;

constexpr int kFailure = 2;

constexpr const char* kMainExamples = R"(Examples:
  fcl-ccd run cloth_0.ply cloth_1.ply
  fcl-ccd run hand_*.obj --against cup_*.obj --contacts contacts.csv --json times.json
  fcl-ccd queries edge-edge.csv --kind ee --json errors.json

'fcl-ccd COMMAND --help' tells more. Exit code: 0 when done, with or without contacts;
2 on any error, in which case no output file is written or changed.)";

constexpr const char* kRunDetails = R"(Frames:
  All frames of a mesh have the same vertices and faces in the same order. Read are OBJ,
  PLY (ascii and binary, float and double) and OFF (text). Polygons with more than three
  vertices become the fan of triangles around their first vertex. Step i goes from frame i
  to frame i + 1, counted from 0; vertices move on straight lines.

What is tested:
  Without --against: A against itself. With --against: A against itself and A against B,
  never B against itself; --no-self leaves A against B.

Output:
  A contact counts as vf (vertex-face) or ee (edge-edge); each is proved, so that the
  table's 'uncertain' is 0. 'vertices' and 'triangles' count those of all meshes. With
  '--query first' the contacts are those that may be the first, with '--query any'
  at most one, not always the earliest.
  --contacts: step,kind,i0,i1,i2,i3,toc_lo,toc_hi with kind vf (vertex, face) or ee (edge
  a, edge b); ids count from 0, those of B are prefixed b; the first time of contact lies
  in [toc_lo, toc_hi], in fractions of the step.
  --json: times in milliseconds; build: the hierarchy, in step 0; total = update +
  traverse + test.
  --paint: vertices of vf contacts red, of ee contacts orange, of the edge and face that
  cross at t = 0 violet; B's vertices follow A's.

Examples:
  fcl-ccd run cloth_0.ply cloth_1.ply cloth_2.ply --json times.json --repeat 5
  fcl-ccd run cloth_0.ply cloth_1.ply --query first
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

CLI::App* addRun(CLI::App& app, fcl_ccd::RunOptions& options) {
  constexpr int kUnlimited = -1;
  CLI::App* run = app.add_subcommand("run", "Continuous collision of meshes in motion");
  run->footer(kRunDetails);
  run->add_option("A", options.frames, "Frames of mesh A, at least two")
      ->type_name("FILE")
      ->required()
      ->expected(2, kUnlimited);
  run->add_option("--against", options.against, "Frames of mesh B, as many as of A")
      ->type_name("FILE")
      ->expected(2, kUnlimited);
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
  run->add_option("--threads", options.settings.num_threads,
                  "Threads of a build, an update or a query; 0: as many as there are")
      ->type_name("N")
      ->check(CLI::Validator(
          [](const std::string& text) {
            int value = -1;
            const bool valid = CLI::detail::lexical_cast(text, value) && value >= 0;
            return valid ? std::string() : "'" + text + "' is not a number of threads";
          },
          ""))
      ->capture_default_str();
  run->add_option("--contacts", options.contacts_path, "Write the contacts as CSV")
      ->type_name("FILE")
      ->check(named());
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
  static const std::map<std::string, FeatureKind> kKinds{{"vf", FeatureKind::kVertexFace},
                                                         {"ee", FeatureKind::kEdgeEdge}};
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
  return kFailure;
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
    if (run->parsed() && !run_options.against.empty() &&
        run_options.against.size() != run_options.frames.size())
      throw CLI::ValidationError("--against", "A and B need the same number of frames");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kFailure;
  }

  fcl_ccd::removeTemporariesOnSignal();
  if (run->parsed())
    fcl_ccd::runCommand(run_options);
  else
    fcl_ccd::queriesCommand(queries_options);
  return 0;
} catch (const std::bad_alloc&) {
  return reportFailure("out of memory");
} catch (const std::exception& error) {
  return reportFailure(error.what());
}
