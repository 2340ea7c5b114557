// SPDX-License-Identifier: BSD-3-Clause
#include "moment_file.h"

#include "frame_list.h"

namespace fcl_ccd {

MomentFile::MomentFile(const std::string& path, bool is_of_first)
    : path_(path), is_of_first_(is_of_first) {
  if (!hasNumber(path)) file_.emplace(path);
}

void MomentFile::add(std::size_t number, const std::string& bytes, bool has_contact) {
  if (bytes.empty()) return;
  if (!file_) {
    OutputFile file(withNumber(path_, number));
    file.write(bytes);
    file.finish();
    file.publish();
    return;
  }
  // Steps that were done side by side each may have been the first one with a contact.
  if (is_of_first_ && has_contact_) return;
  bytes_ = bytes;
  has_contact_ = has_contact;
}

OutputFile* MomentFile::finish() {
  if (!file_ || bytes_.empty()) return nullptr;
  file_->write(bytes_);
  file_->finish();
  return &*file_;
}

}  // namespace fcl_ccd
