// SPDX-License-Identifier: BSD-3-Clause
//
// The command line: options and help.
#include <fcl/config.h>
#include <fcntl.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <limits>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "fcl/ccd_version.h"
#include "mesh_io.h"
#include "output_file.h"
#include "queries_command.h"
#include "ranks.h"
#include "run_command.h"
#include "run_inputs.h"
#include "stop_signal.h"
#include "suggestion.h"

namespace {

using fcl::ContinuousContactKind;
using fcl::ContinuousQuery;

constexpr const char* kMainExamples = R"(Examples:
  fcl-ccd run cloth_0.ply cloth_1.ply
  fcl-ccd run frames/ --against body.obj --contacts contacts.csv --steps steps.jsonl
  fcl-ccd queries edge-edge.csv --kind ee --json errors.json

'fcl-ccd COMMAND --help' explains a command. Exit code: 0 when done, with or without
contacts; 2 when the command is refused and no output file is written or changed; 3 and
above when a run stops before its end ('fcl-ccd run --help').)";

constexpr const char* kRunDetails = R"(Frames:
  FRAMES is a file, a folder (its meshes; f9 comes before f10), a pattern in quotes
  ('frames/*.ply') or a name with a number (frame_%04d.ply). --start, --end and --stride
  select frames of the last three: numbers for %04d, otherwise files counted from 0.
  All frames of a mesh have the same vertices and faces in the same order.
  Formats: OBJ, PLY (ascii and binary, float and double), OFF (text), STL (ascii and
  binary). Polygons are divided into triangles, in all frames as in the first. A convex
  polygon that turns at every corner becomes the fan of triangles around its first vertex.
  Lines and points of OBJ, and edges of PLY, are cables and points. With --columns
  triangles their numbers begin with e and p.
  All files are checked before the first step. Positions in binary PLY files are checked
  in their step.
  Step i goes from frame i to the next one. Vertices move on straight lines. Frames are
  counted from 0, or have the number in their name (%04d).
  If files at the end are not whole yet, the steps before them are done, and the exit code
  is 6. --follow waits for frames until --end, Ctrl-C, or SECONDS without a new one.

Tests:
  Without --against: A against itself. With --against: A against itself and A against B,
  never B against itself. With --no-self: A against B only. If B has one frame, it does
  not move.
  If no triangle of a mesh shares a vertex, neighbours are reported as contacts. --weld
  joins the vertices that coincide in all frames. Ids are those of the file.

Output:
  A contact is vf (vertex-face) or ee (edge-edge). Each contact is proved. 'crossing' tells
  whether an edge passes through a face at the beginning of the step. 'vertices' and
  'triangles' count those of all meshes.
  With --thickness, features are in contact when their distance reaches D. Then ve (a vertex
  and an edge) and vv (two vertices) are contacts too.
  '--query first' reports the contacts that may be the first. '--query any' reports at most
  one contact. If A touches itself it does not look at B, and says what is not decided.
  --contacts: CSV with the columns step,kind,i0,i1,i2,i3,toc_lo,toc_hi,i4. kind is vf (i0 is
  the vertex, i1 to i3 the face), ee (i0 and i1 are edge a, i2 and i3 edge b) or crossing
  (i0 and i1 are the edge, i2 to i4 the face); ve has no i3, vv no i2 and i3. Ids count from
  0; ids of B begin with b. The first time of contact lies in [toc_lo, toc_hi], in fractions
  of the step. --columns adds, before i4, t0,t1 (the triangles of both features), x,y,z (the
  point where they touch) and nx,ny,nz (unit normal, A to B).
  --steps: JSON lines: the options, one object for each step, and a summary at the end.
  --json: JSON with all steps and their times in milliseconds. build: making the tree, in
  the first step of each job. total = update + traverse + test.
  --paint: PLY of the last frame. Vertices of vf, ve and vv contacts are red, those of ee
  contacts orange, those of an edge and a face that cross at t = 0 violet. B's vertices come
  after A's.
  --contacts and --steps grow with each step. --json and --paint are written at the end.
  One output may be '-', standard output. Then the table goes to standard error.

Stopping:
  After Ctrl-C, SIGTERM or SIGHUP the steps that have begun are finished. Another signal,
  half a second after the first or later, ends the program at once.
  --resume continues after the last whole step in the files of --contacts and --steps. At
  the end the files are as if the run had never stopped. There may be more frames than
  before, but not with --weld.
  Outputs are locked: a second run that names one of them is refused.
  Exit code: 0 done; 2 refused, no file written or changed; 3 a later frame cannot be read
  or used; 4 an output cannot be written (disk full), or another program took it away; 5 a
  rank of mpirun died; 6 the last frames are not whole yet; 128 + N stopped by signal N.
  After 3 and above the files have all steps that were done, unless they were taken away.

Cores:
  By default the program does as many steps at the same time as there are cores. With
  --repeat or --threads it does one step after the other, so that the times are those of a
  step that has the machine to itself. With --jobs and --threads it does so many steps at
  the same time, with so many threads each. The output is the same.
  'mpirun -n K fcl-ccd run ...' splits the steps over K processes (ranks), also on several
  machines. Rank 0 writes the same files. Each rank does one step at a time, or --jobs.

Examples:
  fcl-ccd run cloth_0.ply cloth_1.ply cloth_2.ply --json times.json --repeat 5
  fcl-ccd run cloth_0.ply cloth_1.ply --query first
  fcl-ccd run cloth_0.ply cloth_1.ply --thickness 0.001 --ignore-initially-closer
  fcl-ccd run frames/ --against body.obj --contacts contacts.csv --steps steps.jsonl
  fcl-ccd run frames/ --against body.obj --contacts contacts.csv --steps steps.jsonl --resume
  fcl-ccd run frame_%04d.ply --start 100 --end 199 --contacts contacts.csv
  mpirun -n 4 fcl-ccd run frames/ --contacts contacts.csv --steps steps.jsonl
  fcl-ccd run --against ball_0.obj ball_1.obj --no-self -- cloth_0.obj cloth_1.obj
  fcl-ccd run cloth_0.ply cloth_1.ply --contacts contacts.csv --paint contacts.ply)";

constexpr const char* kQueriesDetails = R"(Input:
  Eight rows for each query: four points at t = 0, then the same points at t = 1. The points
  are a vertex and a face (--kind vf), or edge a and edge b (--kind ee). A row is
  num,den,num,den,num,den: x, y and z as fractions of integers of any size. A seventh field
  may be 0 or 1: whether the features truly touch. Coordinates become the nearest double.

Output:
  Without --print: a table of counts and errors.
  --print: index,answer,toc_lo,toc_hi for each query; answer is yes or no. Each answer is
  proved, so that 'uncertain' is 0.
  --json: the counts. Those that need the seventh field are null without it.

Examples:
  fcl-ccd queries vertex-face.csv --kind vf
  fcl-ccd queries a/edge-edge.csv b/edge-edge.csv --kind ee --repeat 10 --json errors.json
  fcl-ccd queries edge-edge.csv --kind ee --print > answers.csv)";

/// @brief A validator that accepts finite numbers of a type above 0. (CLI11's own accepts
/// inf, and its message for a word is the range of double.)
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

/// @brief A validator that accepts finite numbers of a type from 0 on.
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

/// @brief A validator that accepts the names of a map and replaces them by their values.
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

/// @brief A validator of names of output files.
CLI::Validator named() {
  return {[](const std::string& text) {
            return text.empty() ? "no file is named: the name is empty" : std::string();
          },
          ""};
}

/// @brief A validator of names of PLY files. A name without extension may be a device.
CLI::Validator namedPly() {
  return {[](const std::string& text) {
            const std::string extension = fcl_ccd::extensionOf(text);
            return extension.empty() || extension == "ply"
                       ? std::string()
                       : text +
                             ": cannot write: this option writes PLY. Give a name that "
                             "ends in .ply";
          },
          ""};
}

void addCommonOptions(CLI::App& command, double& toc_err, int& repeat,
                      std::string& json_path) {
  command
      .add_option("--toc-err", toc_err,
                  "Largest width of a contact's time bracket, in fractions of the step; "
                  "0: as narrow as numbers allow")
      ->type_name("X")
      ->check(notNegative<double>("a number from 0 on"))
      ->capture_default_str();
  command
      .add_option("--repeat", repeat, "Do everything N times, report the smallest time")
      ->type_name("N")
      ->check(positive<int>("a positive whole number"))
      ->capture_default_str();
  command.add_option("--json", json_path, "Write the results as JSON")
      ->type_name("FILE")
      ->check(named());
}

/// @brief Reads the names of columns, which are separated by commas.
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

void addFrameOptions(CLI::App& run, fcl_ccd::RunOptions& options) {
  constexpr int kUnlimited = -1;
  run.add_option("A", options.frames, "Frames of mesh A, at least two")
      ->type_name("FRAMES")
      ->required()
      ->expected(1, kUnlimited);
  run.add_option("--against", options.against,
                 "Frames of mesh B: as many as of A, or one if it does not move")
      ->type_name("FRAMES")
      ->expected(1, kUnlimited);
  run.add_option("--start", options.range.start,
                 "First frame; steps have the numbers of the frames where they begin")
      ->type_name("N");
  run.add_option("--end", options.range.end, "Last frame")->type_name("N");
  run.add_option("--stride", options.range.stride, "Take each N-th frame")
      ->type_name("N")
      ->check(positive<int>("a positive whole number"))
      ->capture_default_str();
}

/// @brief A validator of the time of --follow.
CLI::Validator timeLimit() {
  return {[](std::string& text) {
            double seconds = -1;
            const bool valid = CLI::detail::lexical_cast(text, seconds) && seconds >= 0;
            return valid ? std::string()
                         : "'" + text + "' is not a number of seconds. Write the " +
                               "frames before --follow";
          },
          ""};
}

void addFollowOption(CLI::App& run, fcl_ccd::RunOptions& options) {
  run.add_option("--follow", options.follow,
                 "Wait for frames that are still to come, until none came for SECONDS")
      ->type_name("[SECONDS]")
      ->expected(0, 1)
      ->default_str("inf")
      ->check(timeLimit());
}

void addTestOptions(CLI::App& run, fcl_ccd::RunOptions& options) {
  run.add_flag_callback(
         "--no-self", [&options] { options.settings.self = false; },
         "Do not test A against itself")
      ->needs("--against");
  static const std::map<std::string, ContinuousQuery> kQueries{
      {"all", ContinuousQuery::kAll},
      {"first", ContinuousQuery::kFirst},
      {"any", ContinuousQuery::kAny}};
  run.add_option("--query", options.settings.query, "all, first or any (default: all)")
      ->type_name("WHAT")
      ->transform(oneOf(kQueries, "all, first or any"));
  run.add_option("--thickness", options.settings.min_distance,
                 "Contact at this distance, in the unit of the files (default: touching)")
      ->type_name("D")
      ->check(positive<double>("a positive number"));
  run.add_flag("--ignore-initially-closer", options.settings.ignore_initially_closer,
               "Pairs that begin nearer than D are contacts only when they come nearer")
      ->needs("--thickness");
}

void addWorkOptions(CLI::App& run, fcl_ccd::RunOptions& options) {
  run.add_option(
         "--jobs", options.jobs,
         "Steps at the same time, one thread each unless there is --threads; 0: as "
         "many as there are cores")
      ->type_name("N")
      ->check(notNegative<int>("a number of jobs"));
  run.add_option(
         "--threads", options.threads,
         "Threads of a step, one step after the other unless there is --jobs; 0: as many "
         "as there are cores")
      ->type_name("N")
      ->check(notNegative<int>("a number of threads"));
  run.add_option("--weld", options.weld,
                 "Join vertices that coincide in all frames, within EPS (default: 0)")
      ->type_name("[EPS]")
      ->expected(0, 1)
      ->default_str("0")
      ->check(notNegative<double>("a distance"));
}

void addOutputOptions(CLI::App& run, fcl_ccd::RunOptions& options) {
  run.add_option("--contacts", options.contacts_path,
                 "Write the contacts as CSV; -: to standard output")
      ->type_name("FILE")
      ->check(named());
  run.add_option_function<std::string>(
         "--columns",
         [&options](const std::string& list) { options.columns = parseColumns(list); },
         "More columns: triangles,position,normal")
      ->type_name("LIST")
      ->needs("--contacts");
  run.add_option("--steps", options.steps_path,
                 "Write a JSON object for each step when it is done")
      ->type_name("FILE")
      ->check(named());
  run.add_flag("--resume", options.resume,
               "Continue the files of --contacts and --steps");
  run.add_option("--paint", options.paint_path,
                 "Write the last frame as PLY, with contacts in colour")
      ->type_name("FILE")
      ->check(named())
      ->check(namedPly());
}

// The order is that of the help.
CLI::App* addRun(CLI::App& app, fcl_ccd::RunOptions& options) {
  CLI::App* run = app.add_subcommand("run", "Continuous collision of meshes in motion");
  run->footer(kRunDetails);
  addFrameOptions(*run, options);
  addFollowOption(*run, options);
  addTestOptions(*run, options);
  addWorkOptions(*run, options);
  addOutputOptions(*run, options);
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
  queries->add_flag("--print", options.print_answers,
                    "Print one line for each query, not the table");
  addCommonOptions(*queries, options.toc_err, options.repeat, options.json_path);
  return queries;
}

/// Opens a file that cannot be written to for each standard stream that is closed.
/// Otherwise the next file that is opened would become that stream, and the table would
/// be written into it.
void occupyStandardStreams() {
  int file;
  do file = open("/dev/null", O_RDONLY);
  while (file >= 0 && file <= STDERR_FILENO);
  if (file >= 0) close(file);
}

/// Keeps the memory of a step for the next one. By default glibc gives large blocks back
/// to the system, which fills them with zeros again: half of the time of a run whose
/// steps have 100,000 contacts. The memory of a thread consists of heaps of 64 MiB. An
/// empty one is given back unless the pad is as large.
void keepFreedMemory() {
#ifdef __GLIBC__
  constexpr int kLargestBlock = 1 << 30, kHeap = 64 << 20;
  mallopt(M_MMAP_THRESHOLD, kLargestBlock);
  mallopt(M_TRIM_THRESHOLD, kLargestBlock);
  mallopt(M_TOP_PAD, kHeap);
#endif
}

int reportFailure(const char* what) {
  std::fprintf(stderr, "fcl-ccd: %s\n", what);
  return fcl_ccd::kRefused;
}

/// Prints what the parser says, on one rank.
int endParsing(const CLI::App& app, const CLI::ParseError& error,
               const fcl_ccd::Ranks& ranks) {
  std::ostringstream unread;
  const int code = ranks.rank() == 0 ? app.exit(error) : app.exit(error, unread, unread);
  return code == 0 ? 0 : fcl_ccd::kRefused;
}

/// The command with a name, or null.
const CLI::App* commandOf(const CLI::App& app, const std::string& name) {
  for (const CLI::App* command : app.get_subcommands({}))
    if (command->get_name() == name) return command;
  return nullptr;
}

/// The first word if it is neither a command nor an option; otherwise an empty text.
std::string unknownCommand(const CLI::App& app, int argc, char** argv) {
  const bool is_word = argc > 1 && argv[1][0] != '-';
  return is_word && commandOf(app, argv[1]) == nullptr ? argv[1] : "";
}

/// Refuses a word that is no command, and names the one that was perhaps meant.
std::string refusalOf(const std::string& word, const CLI::App& app) {
  std::vector<std::string> names;
  std::string list;
  for (const CLI::App* command : app.get_subcommands({})) {
    names.push_back(command->get_name());
    list += (list.empty() ? "" : ", ") + command->get_name();
  }
  const std::string nearest = fcl_ccd::nearestName(word, names);
  return "'" + word + "' is not a command. " +
         (nearest.empty() ? "" : "Did you mean '" + nearest + "'? ") +
         "The commands are: " + list + ". 'fcl-ccd --help' explains them";
}

/// "Did you mean --contacts?" if an option is mistyped; otherwise an empty text.
std::string suggestionFor(const CLI::App& command, int argc, char** argv) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (int i = 2; i < argc; ++i) {
    const std::string word =
        std::string(argv[i]).substr(0, std::string(argv[i]).find('='));
    if (word == "--") break;
    if (word.rfind("--", 0) != 0 || command.get_option_no_throw(word) != nullptr)
      continue;
    const std::string nearest = fcl_ccd::nearestName(word, names);
    if (!nearest.empty())
      return std::string(word).append(": did you mean ").append(nearest).append("?");
  }
  return "";
}

/// The command line as one text.
std::string joined(int argc, char** argv) {
  std::string text;
  for (int i = 1; i < argc; ++i) text.append(argv[i]).append(1, '\0');
  return text;
}

int runProgram(int argc, char** argv, fcl_ccd::Ranks& ranks) {
  CLI::App app("Continuous collision detection for triangle meshes that deform");
  app.name("fcl-ccd");
  app.footer(kMainExamples);
  app.set_version_flag("--version", "fcl-ccd " FCL_CCD_VERSION " (FCL " FCL_VERSION ")");
  app.require_subcommand(1);
  fcl_ccd::RunOptions run_options;
  fcl_ccd::QueriesOptions queries_options;
  const CLI::App* run = addRun(app, run_options);
  const CLI::App* queries = addQueries(app, queries_options);
  const std::string unknown = unknownCommand(app, argc, argv);
  if (!unknown.empty()) {
    if (ranks.rank() == 0) reportFailure(refusalOf(unknown, app).c_str());
    return fcl_ccd::kRefused;
  }
  try {
    app.parse(argc, argv);
    if (run_options.resume && run_options.contacts_path.empty() &&
        run_options.steps_path.empty())
      throw CLI::ValidationError("--resume", "needs --contacts or --steps to continue");
    if (queries->parsed() && ranks.size() > 1)
      throw CLI::ValidationError("queries",
                                 "runs in one process: start it without mpirun");
  } catch (const CLI::ParseError& error) {
    const int code = endParsing(app, error, ranks);
    const CLI::App* command = argc > 1 ? commandOf(app, argv[1]) : nullptr;
    const std::string suggestion =
        code != 0 && command != nullptr ? suggestionFor(*command, argc, argv) : "";
    if (!suggestion.empty() && ranks.rank() == 0) reportFailure(suggestion.c_str());
    return code;
  }
  run_options.range.is_growing = run_options.follow.has_value();

  if (run->parsed()) {
    fcl_ccd::catchStopSignals();
    return fcl_ccd::runCommand(run_options, ranks, joined(argc, argv));
  }
  fcl_ccd::removeTemporariesOnSignal();
  fcl_ccd::queriesCommand(queries_options);
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  occupyStandardStreams();
  keepFreedMemory();
  fcl_ccd::Ranks ranks;
  return runProgram(argc, argv, ranks);
} catch (const fcl_ccd::StoppedBySignal& stopped) {
  reportFailure(stopped.what());
  return fcl_ccd::kSignalled + fcl_ccd::stopSignal();
} catch (const std::bad_alloc&) {
  return reportFailure(
      "out of memory. Fewer --jobs need less: each step holds two frames and a tree");
} catch (const std::exception& error) {
  return reportFailure(error.what());
}
