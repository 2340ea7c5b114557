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
#include <algorithm>
#include <cstdio>
#include <exception>
#include <limits>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "candidates_command.h"
#include "compare_command.h"
#include "fcl/ccd_version.h"
#include "help_text.h"
#include "mesh_io.h"
#include "output_file.h"
#include "queries_command.h"
#include "ranks.h"
#include "run_command.h"
#include "run_inputs.h"
#include "scene_command.h"
#include "scene_file.h"
#include "show_options.h"
#include "stop_signal.h"
#include "suggestion.h"

namespace {

using fcl::ContinuousContactKind;
using fcl::ContinuousQuery;

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
      ->check(fcl_ccd::namedFile());
}

/// @brief Adds the option for the columns of a CSV output.
/// @param parse  takes the list; its std::runtime_error becomes one of the option.
template <typename Parse>
CLI::Option* addColumnsOption(CLI::App& command, const char* help, Parse parse) {
  return command
      .add_option_function<std::string>(
          "--columns",
          [parse](const std::string& list) {
            try {
              parse(list);
            } catch (const std::runtime_error& error) {
              throw CLI::ValidationError("--columns", error.what());
            }
          },
          help)
      ->type_name("LIST");
}

void addAgainstOption(CLI::App& command, fcl_ccd::RunOptions& options) {
  constexpr int kUnlimited = -1;
  command
      .add_option("--against", options.against,
                  "Frames of mesh B: as many as of A, or one if it does not move")
      ->type_name("FRAMES")
      ->expected(1, kUnlimited);
}

void addFrameOptions(CLI::App& run, fcl_ccd::RunOptions& options) {
  constexpr int kUnlimited = -1;
  run.add_option("A", options.frames,
                 "Frames of mesh A, at least two; or a scene, FILE.json")
      ->type_name("FRAMES")
      ->required()
      ->expected(1, kUnlimited);
  addAgainstOption(run, options);
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

void addNoSelfOption(CLI::App& command, fcl_ccd::RunOptions& options) {
  command
      .add_flag_callback(
          "--no-self", [&options] { options.settings.self = false; },
          "Do not test A against itself")
      ->needs("--against");
}

void addThicknessOption(CLI::App& command, fcl_ccd::RunOptions& options) {
  command
      .add_option(
          "--thickness", options.settings.min_distance,
          "Contact at this distance, in the unit of the files (default: touching)")
      ->type_name("D")
      ->check(positive<double>("a positive number"));
}

void addWeldOption(CLI::App& command, fcl_ccd::RunOptions& options) {
  command
      .add_option("--weld", options.weld,
                  "Join vertices that coincide in all frames, within EPS (default: 0)")
      ->type_name("[EPS]")
      ->expected(0, 1)
      ->default_str("0")
      ->check(notNegative<double>("a distance"));
}

void addTestOptions(CLI::App& run, fcl_ccd::RunOptions& options) {
  addNoSelfOption(run, options);
  static const std::map<std::string, ContinuousQuery> kQueries{
      {"all", ContinuousQuery::kAll},
      {"first", ContinuousQuery::kFirst},
      {"any", ContinuousQuery::kAny}};
  run.add_option("--query", options.settings.query, "all, first or any (default: all)")
      ->type_name("WHAT")
      ->transform(oneOf(kQueries, "all, first or any"));
  addThicknessOption(run, options);
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
  addWeldOption(run, options);
}

void addOutputOptions(CLI::App& run, fcl_ccd::RunOptions& options) {
  run.add_option("--contacts", options.contacts_path,
                 "Write the contacts as CSV; -: to standard output")
      ->type_name("FILE")
      ->check(fcl_ccd::namedFile());
  addColumnsOption(run, "Columns of the contacts; see below",
                   [&options](const std::string& list) {
                     options.columns = fcl_ccd::ContactColumns(list);
                   })
      ->needs("--contacts");
  run.add_option("--steps", options.steps_path,
                 "Write a JSON object for each step when it is done")
      ->type_name("FILE")
      ->check(fcl_ccd::namedFile());
  run.add_flag("--resume", options.resume,
               "Continue the files of --contacts and --steps");
  fcl_ccd::addShowOptions(run, options);
}

// The order is that of the help.
CLI::App* addRun(CLI::App& app, fcl_ccd::RunOptions& options) {
  CLI::App* run = app.add_subcommand("run", "Continuous collision of meshes in motion");
  run->footer(fcl_ccd::kRunDetails);
  addFrameOptions(*run, options);
  addFollowOption(*run, options);
  addTestOptions(*run, options);
  addWorkOptions(*run, options);
  addOutputOptions(*run, options);
  addCommonOptions(*run, options.settings.toc_err, options.settings.repeat,
                   options.json_path);
  return run;
}

void addCandidates(CLI::App& app, fcl_ccd::CandidatesOptions& options) {
  CLI::App* candidates =
      app.add_subcommand("candidates", "Pairs of features of a step that may touch");
  candidates->footer(fcl_ccd::kCandidatesDetails);
  constexpr int kUnlimited = -1;
  candidates->add_option("A", options.step.frames, "The two frames of mesh A")
      ->type_name("FRAMES")
      ->required()
      ->expected(1, kUnlimited);
  addAgainstOption(*candidates, options.step);
  addNoSelfOption(*candidates, options.step);
  addThicknessOption(*candidates, options.step);
  addWeldOption(*candidates, options.step);
  candidates->add_option("--output", options.output_path, "Write the candidates as CSV")
      ->type_name("FILE")
      ->check(fcl_ccd::namedFile())
      ->capture_default_str();
  addColumnsOption(*candidates, "Columns, in this order; see below",
                   [&options](const std::string& list) {
                     options.columns =
                         fcl_ccd::parseColumns(list, fcl_ccd::candidateColumns());
                   });
}

void addKindOption(CLI::App& command, std::optional<ContinuousContactKind>& kind) {
  static const std::map<std::string, ContinuousContactKind> kKinds{
      {"vf", ContinuousContactKind::kVertexFace},
      {"ee", ContinuousContactKind::kEdgeEdge}};
  command
      .add_option("--kind", kind,
                  "vf (vertex-face) or ee (edge-edge); default: what the names tell")
      ->type_name("KIND")
      ->transform(oneOf(kKinds, "vf or ee"));
}

CLI::App* addQueries(CLI::App& app, fcl_ccd::QueriesOptions& options) {
  CLI::App* queries =
      app.add_subcommand("queries", "Elementary vertex-face or edge-edge queries");
  queries->footer(fcl_ccd::kQueriesDetails);
  queries->add_option("FILES", options.files, "CSV files of queries, or folders of them")
      ->type_name("FILE")
      ->required();
  addKindOption(*queries, options.kind);
  queries->add_flag("--print", options.print_answers,
                    "Print one line for each query, not the table");
  addColumnsOption(*queries, "Columns of the lines, in this order; see below",
                   [&options](const std::string& list) {
                     options.columns =
                         fcl_ccd::parseColumns(list, fcl_ccd::answerColumns());
                   })
      ->needs("--print");
  addCommonOptions(*queries, options.toc_err, options.repeat, options.json_path);
  return queries;
}

CLI::App* addCompare(CLI::App& app, fcl_ccd::CompareOptions& options) {
  CLI::App* compare =
      app.add_subcommand("compare", "Compare answers with the truth of public data");
  compare->footer(fcl_ccd::kCompareDetails);
  constexpr int kUnlimited = -1;
  compare
      ->add_option(
          "FILES", options.inputs,
          "CSV files of queries, or folders of them; or the two frames of a step")
      ->type_name("FILE")
      ->required()
      ->expected(1, kUnlimited);
  addKindOption(*compare, options.kind);
  compare
      ->add_option("--truth", options.truth,
                   "JSON files of the truth (default: those beside the FILES)")
      ->type_name("FILE")
      ->expected(1, kUnlimited);
  addCommonOptions(*compare, options.toc_err, options.repeat, options.json_path);
  return compare;
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

/// The scene file among the words of `run`, or null.
const std::string* sceneFileOf(const fcl_ccd::RunOptions& options) {
  const auto found =
      std::find_if(options.frames.begin(), options.frames.end(), fcl_ccd::isSceneFile);
  return found == options.frames.end() ? nullptr : &*found;
}

[[noreturn]] void refuseForScene(const std::string& path, const std::string& option) {
  throw std::runtime_error(
      path + ": --" + option + " is for frames, and not for a scene. " +
      (option == "thickness" ? "Write the field 'thickness' of the objects. " : "") +
      "A scene takes --query, --contacts, --json, --threads, --toc-err, --start and "
      "--end");
}

/// Takes the options of a scene from those of `run`, and refuses all others.
fcl_ccd::SceneOptions sceneOptionsOf(const CLI::App& run,
                                     const fcl_ccd::RunOptions& options,
                                     const std::string& path) {
  const std::vector<std::string> known{"query",   "contacts", "json", "threads",
                                       "toc-err", "start",    "end"};
  for (const CLI::Option* option : run.get_options())
    for (const std::string& name : option->get_lnames())
      if (option->count() > 0 &&
          std::find(known.begin(), known.end(), name) == known.end())
        refuseForScene(path, name);
  if (options.frames.size() > 1)
    throw std::runtime_error(path +
                             ": a scene is named alone, without other files. Run "
                             "each scene by itself");
  return {path,
          options.settings.query,
          options.settings.toc_err,
          options.threads.value_or(0),
          options.range,
          options.contacts_path,
          options.json_path};
}

/// `run` with frames or with a scene file.
int runFramesOrScene(const CLI::App& run, const fcl_ccd::RunOptions& options,
                     fcl_ccd::Ranks& ranks, const std::string& command) {
  fcl_ccd::catchStopSignals();
  const std::string* scene = sceneFileOf(options);
  if (scene == nullptr) return fcl_ccd::runCommand(options, ranks, command);
  // mpirun ends all ranks when one ends with another code: rank 0 is to say why.
  if (ranks.rank() != 0) return 0;
  if (ranks.size() > 1)
    throw std::runtime_error(*scene +
                             ": a scene runs in one process: start it without mpirun");
  return fcl_ccd::sceneCommand(sceneOptionsOf(run, options, *scene));
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
  app.footer(fcl_ccd::kMainExamples);
  app.set_version_flag("--version", "fcl-ccd " FCL_CCD_VERSION " (FCL " FCL_VERSION ")");
  app.require_subcommand(1);
  fcl_ccd::RunOptions run_options;
  fcl_ccd::CandidatesOptions candidates_options;
  fcl_ccd::QueriesOptions queries_options;
  fcl_ccd::CompareOptions compare_options;
  const CLI::App* run = addRun(app, run_options);
  addCandidates(app, candidates_options);
  const CLI::App* queries = addQueries(app, queries_options);
  const CLI::App* compare = addCompare(app, compare_options);
  const std::string unknown = unknownCommand(app, argc, argv);
  if (!unknown.empty()) {
    if (ranks.rank() == 0) reportFailure(refusalOf(unknown, app).c_str());
    return fcl_ccd::kRefused;
  }
  try {
    app.parse(argc, argv);
    fcl_ccd::expandReport(run_options);
    if (run_options.resume && run_options.contacts_path.empty() &&
        run_options.steps_path.empty())
      throw CLI::ValidationError("--resume", "needs --contacts or --steps to continue");
    if (!run->parsed() && ranks.size() > 1)
      throw CLI::ValidationError(app.get_subcommands().at(0)->get_name(),
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

  if (run->parsed())
    return runFramesOrScene(*run, run_options, ranks, joined(argc, argv));
  fcl_ccd::removeTemporariesOnSignal();
  if (queries->parsed())
    fcl_ccd::queriesCommand(queries_options);
  else if (compare->parsed())
    fcl_ccd::compareCommand(compare_options);
  else
    fcl_ccd::candidatesCommand(candidates_options);
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
