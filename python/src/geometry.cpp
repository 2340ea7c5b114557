// SPDX-License-Identifier: BSD-3-Clause
#include "geometry.h"

#include <stdexcept>
#include <string>

namespace fcl_ccd {
namespace python {

void Guarded::Reading::add(const Guarded& read) {
  if (read.is_written_)
    throw std::runtime_error(std::string("the ") + read.name_ +
                             " is being updated by another thread. Wait until the "
                             "update has ended");
  read_.push_back(&read);
  ++read.num_readers_;
  read.addParts(*this);
}

Guarded::Writing::Writing(const Guarded& written) : written_(written) {
  if (written.is_written_ || written.num_readers_ > 0) {
    const std::string name = written.name_;
    throw std::runtime_error(
        "a query or an update of the " + name +
        " has not ended, in another thread or in the caller of this function. Update "
        "the " +
        name + " when it has ended");
  }
  written.is_written_ = true;
}

}  // namespace python
}  // namespace fcl_ccd
