// SPDX-License-Identifier: BSD-3-Clause
#include "show_options.h"

#include <filesystem>
#include <initializer_list>
#include <string>
#include <utility>

#include "mesh_io.h"
#include "output_file.h"

namespace fcl_ccd {
namespace {

/// A validator of names with an extension. A name without extension may be a device.
CLI::Validator namedAs(const std::string& extension, const std::string& format) {
  return {[=](const std::string& text) {
            const std::string found = extensionOf(text);
            return found.empty() || found == extension
                       ? std::string()
                       : text + ": cannot write: this option writes " + format +
                             ". Give a name that ends in ." + extension;
          },
          ""};
}

/// A validator of names that may have a number.
CLI::Validator numbered() {
  return {[](const std::string& text) {
            try {
              hasNumber(text);
            } catch (const std::exception& error) {
              return std::string(error.what());
            }
            return std::string();
          },
          ""};
}

CLI::Validator fractionOfStep() {
  return {[](std::string& text) {
            double time = -1;
            const bool valid =
                CLI::detail::lexical_cast(text, time) && time >= 0 && time <= 1;
            return valid ? std::string() : "'" + text + "' is not a time from 0 to 1";
          },
          ""};
}

void requireMoments(const RunOptions& options) {
  const ShownMoments& shown = options.shown;
  const std::initializer_list<std::pair<const char*, const std::string*>> files = {
      {"--picture", &options.picture_path}, {"--paint", &options.paint_path}};
  bool has_file = false;
  for (const auto& [option, path] : files) {
    has_file |= !path->empty();
    if (!path->empty() && shown.steps.size() > 1 && !hasNumber(*path))
      throw CLI::ValidationError(
          option, "of several steps needs a name with a number, such as contact_%04d." +
                      extensionOf(*path));
  }
  if (!has_file && !shown.steps.empty())
    throw CLI::ValidationError("--at-step", "needs --picture or --paint");
  if (!has_file && shown.time)
    throw CLI::ValidationError("--at-time", "needs --picture or --paint");
}

}  // namespace

CLI::Validator namedFile() {
  return {[](const std::string& text) {
            return text.empty() ? "no file is named: the name is empty" : std::string();
          },
          ""};
}

void addShowOptions(CLI::App& run, RunOptions& options) {
  run.add_option(
         "--report", options.report_path,
         "Write a page with plots, the first contacts and a 3D view; a folder gets "
         "more files")
      ->type_name("DIR|FILE.html")
      ->check(namedFile());
  run.add_option("--picture", options.picture_path,
                 "Draw the moment of the first contact as PNG")
      ->type_name("FILE")
      ->check(namedFile())
      ->check(namedAs("png", "PNG"))
      ->check(numbered());
  run.add_option("--paint", options.paint_path,
                 "Write the mesh at the first contact as PLY, with contacts in colour")
      ->type_name("FILE")
      ->check(namedFile())
      ->check(namedAs("ply", "PLY"))
      ->check(numbered());
  run.add_option("--at-step", options.shown.steps,
                 "Steps of --picture and --paint; more than one for FILE with %04d")
      ->type_name("N,...")
      ->allow_extra_args(false)
      ->delimiter(',');
  run.add_option("--at-time", options.shown.time,
                 "Time of --picture and --paint in the step (default: its first contact)")
      ->type_name("T")
      ->check(fractionOfStep());
}

void expandReport(RunOptions& options) {
  if (!options.report_path.empty() && !isStandardOutput(options.report_path) &&
      extensionOf(options.report_path) != "html") {
    const std::filesystem::path folder = options.report_path;
    options.report_folder = folder.string();
    options.report_path = (folder / "report.html").string();
    const auto name = [&](std::string& path, const char* file) {
      if (path.empty()) path = (folder / file).string();
    };
    if (options.contacts_path.empty())
      options.columns = ContactColumns("triangles,position,normal");
    name(options.contacts_path, "contacts.csv");
    name(options.json_path, "run.json");
    if (options.shown.steps.empty() && !options.shown.time) {
      name(options.picture_path, "first_contact.png");
      name(options.paint_path, "first_contact.ply");
    }
  }
  requireMoments(options);
}

}  // namespace fcl_ccd
