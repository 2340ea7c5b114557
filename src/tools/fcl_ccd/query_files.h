// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_QUERY_FILES_H
#define FCL_CCD_QUERY_FILES_H

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "fcl/narrowphase/continuous_contact_kind.h"
#include "query_csv.h"

namespace fcl_ccd {

/// @brief The kind of pairs that a file is about, by its name: its last word without
/// _mma_bool is vf or vertex-face, ee or edge-edge (92vf.csv, a_ee.json), or its folder
/// is named vertex-face or edge-edge.
std::optional<fcl::ContinuousContactKind> kindByName(const std::string& path);

/// @brief A file of elementary queries of one kind.
struct QueryFile {
  std::string path;
  fcl::ContinuousContactKind kind;
  std::string answers{};  ///< a file of answers (truth_json.h); empty: the rows have them
};

/// @brief The files that the words name. A word is a file, or a folder: all CSV files in
/// it and below, in natural order.
/// @param kind  of all files; of a folder only those are taken whose name tells no other
/// kind. Without it the names tell the kinds.
/// @throws std::runtime_error that names the word if a kind is not known, or a folder has
/// no queries.
std::vector<QueryFile> listQueryFiles(const std::vector<std::string>& words,
                                      std::optional<fcl::ContinuousContactKind> kind);

/// @brief The queries of some files.
struct QuerySet {
  std::vector<QueryFile> files;
  std::vector<ElementaryQuery> queries;
  std::vector<std::size_t> file_of;  ///< of each query
  bool has_truth{false};             ///< whether every query tells if its features touch

  const QueryFile& fileOf(std::size_t query) const { return files[file_of[query]]; }
};

/// @brief Reads the queries and the answers to them. If the rows have the truth, a file
/// of answers must say the same.
/// @throws std::runtime_error that names the file, the line and the cause.
QuerySet readQuerySet(std::vector<QueryFile> files);

/// @brief The number of queries with coordinates that are not doubles.
std::size_t numQueriesNotDoubles(const QuerySet& set);

}  // namespace fcl_ccd

#endif
