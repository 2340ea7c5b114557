// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_RUN_H
#define FCL_CCD_QUERY_RUN_H

#include <cstddef>
#include <vector>

#include "elementary/elementary.h"
#include "query_files.h"

namespace fcl_ccd {

/// @brief Runs the elementary test on a query of the set, or where coordinates are not
/// doubles its exact stage, on the rational numbers.
/// @param toc_err  as of the option --toc-err: 0 or more
fcl::detail::deformable::ElementaryResult runQuery(const QuerySet& set, std::size_t query,
                                                   double toc_err);

/// @brief How answers differ from the truth. All are 0 but `uncertain` if the set has no
/// truth. A time is compared where the features touch and the answer says so.
struct QueryErrors {
  std::size_t num_true{0};
  std::size_t false_negatives{0};
  std::size_t false_positives{0};
  std::size_t uncertain{0};
  std::size_t num_times{0};    ///< true times that are compared
  std::size_t wrong_times{0};  ///< of these, those that are outside of [toc_lo, toc_hi]
};

/// @param results  of all queries of the set
QueryErrors compareWithTruth(
    const QuerySet& set,
    const std::vector<fcl::detail::deformable::ElementaryResult>& results);

}  // namespace fcl_ccd

#endif
