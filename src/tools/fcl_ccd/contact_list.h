// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_CONTACT_LIST_H
#define FCL_CCD_CONTACT_LIST_H

#include <cstddef>
#include <optional>
#include <string>

#include "csv_columns.h"
#include "run_report.h"

namespace fcl_ccd {

/// @brief The columns of the contact list.
class ContactColumns {
 public:
  /// @brief step,kind,i0,i1,i2,i3,toc_lo,toc_hi,i4.
  ContactColumns();

  /// @brief Reads names that are separated by commas: those of single columns, or
  /// triangles (t0,t1), position (x,y,z) and normal (nx,ny,nz). A list of the latter
  /// alone adds them, in this order and before i4, to the columns that are always there.
  /// Any other list has the columns of the file in their order.
  /// @throws std::runtime_error that lists the known names
  explicit ContactColumns(const std::string& list);

  const ColumnNumbers& numbers() const { return numbers_; }

  /// @brief The place of `step` among the columns, if it is there.
  std::optional<std::size_t> placeOfStep() const;

  /// @brief Whether some column is a position or a normal.
  bool needPoints() const;

 private:
  ColumnNumbers numbers_;
};

/// @brief Head and lines of the contact list, each with its line end.
std::string contactsHead(const ContactColumns& columns);
std::string contactLines(const StepReport& report, const ContactColumns& columns);

}  // namespace fcl_ccd

#endif
