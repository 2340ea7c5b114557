// SPDX-License-Identifier: BSD-3-Clause
#include "run_outputs.h"

#include <utility>

#include "json.h"

namespace fcl_ccd {

RunOutputs::RunOutputs(const RunOptions& options, const OutputSet& reserved,
                       const RunSummary& summary)
    : options_(options), reserved_(reserved), summary_(summary) {
  const StepSettings& settings = options.settings;
  print(tableHead(settings.min_distance > 0, settings.query));
  if (!options.json_path.empty()) json_.emplace(options.json_path);
  const ShownMoments& shown = options.shown;
  if (const auto& path = options.picture_path; !path.empty())
    picture_.emplace(path, shown.isOfFirstContact(path));
  if (const auto& path = options.paint_path; !path.empty())
    paint_.emplace(path, shown.isOfFirstContact(path));
  if (!options.report_path.empty()) page_.emplace(options.report_path);
}

void RunOutputs::open(const GrowingOutputs& growing, const ResumePoint& resume_point) {
  open(growing.contacts_path, resume_point.contacts_size, growing.contacts_head,
       contacts_);
  open(growing.steps_path, resume_point.steps_size, growing.steps_head, steps_);
  if (json_) json_->write("{\"steps\": [");
}

void RunOutputs::open(const std::string& path, std::uint64_t kept_size,
                      const std::string& head, std::optional<GrowingFile>& file) {
  if (path.empty()) return;
  file.emplace(reserved_.lockOf(path), kept_size);
  if (kept_size == 0) file->append(head);
  file->commit();
}

void RunOutputs::add(const StepRecord& record) {
  if (contacts_) contacts_->append(record.contact_lines);
  if (steps_) steps_->append(record.step_line);
  if (json_) json_->write((has_json_step_ ? ",\n" : "\n") + record.json);
  has_json_step_ = true;
  const bool has_contact = record.summary.first.has_value();
  if (picture_) picture_->add(record.number, record.picture, has_contact);
  if (paint_) paint_->add(record.number, record.painted, has_contact);
  if (page_) page_->add(record.page);
  if (!summary_.first && !record.page_picture.empty())
    page_picture_ = record.page_picture;
  commit();
  summary_.add(record.summary);
}

void RunOutputs::finish(bool is_complete) {
  Json summary = toJson(summary_);
  if (steps_ && is_complete) steps_->append(Json{{"summary", summary}}.dump() + '\n');
  commit();
  for (auto* file : {&contacts_, &steps_})
    if (*file) (*file)->finish();
  summary["complete"] = is_complete;
  if (json_) json_->write("\n],\n\"summary\": " + summary.dump() + "}\n");
  for (OutputFile* file : finishWholeFiles(is_complete)) file->publish();
}

void RunOutputs::printSummary() const {
  print(summaryLines(summary_, options_.settings.query));
}

void RunOutputs::rollBack() noexcept {
  for (auto* file : {&contacts_, &steps_})
    if (*file) (*file)->rollBack();
}

std::string RunOutputs::whereStepsAre() const {
  std::string where;
  for (const auto* file : {&contacts_, &steps_})
    if (*file && (*file)->isLost()) return "";
  for (const std::string* path : {&options_.contacts_path, &options_.steps_path}) {
    if (path->empty() || isStandardOutput(*path)) continue;
    where += (where.empty() ? "" : " and ") + *path;
  }
  return where;
}

void RunOutputs::commit() {
  for (auto* file : {&contacts_, &steps_})
    if (*file) (*file)->commit();
}

std::vector<OutputFile*> RunOutputs::finishWholeFiles(bool is_complete) {
  std::vector<OutputFile*> files;
  if (page_) {
    page_->finish(summaryLines(summary_, options_.settings.query), page_picture_,
                  is_complete);
    files.push_back(&page_->file());
  }
  if (json_) files.push_back(&*json_);
  for (OutputFile* file : files) file->finish();
  for (auto* shown : {&picture_, &paint_})
    if (*shown)
      if (OutputFile* file = (*shown)->finish()) files.push_back(file);
  return files;
}

void RunOutputs::print(std::string_view text) const {
  fcl_ccd::print(text, reserved_.hasStandardOutput());
}

}  // namespace fcl_ccd
