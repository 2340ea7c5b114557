// SPDX-License-Identifier: BSD-3-Clause
//
// The library's queries of mesh cases. FCL's headers are only in mesh_query.cpp.
#ifndef FCL_FUZZ_MESH_QUERY_H
#define FCL_FUZZ_MESH_QUERY_H

#include <memory>
#include <vector>

#include "family.h"
#include "mesh_case.h"

namespace fcl {

template <typename BV>
class DeformableBVHModel;
template <typename S, std::size_t N>
class KDOP;

namespace test {

using FuzzModel = DeformableBVHModel<KDOP<double, 16>>;

/// @brief What differs between queries of one case.
struct Ask {
  enum class Query { kAll, kFirst, kAny };
  Query query{Query::kAll};
  int num_threads{1};
  /// 0: no limit.
  std::size_t num_max_contacts{0};
};

struct MeshAnswer {
  bool is_collide;
  bool is_crossing;
  bool is_cut;
  double time;
  /// In the order of the library.
  std::vector<NamedBracket> contacts;

  bool operator==(const MeshAnswer& o) const {
    return is_collide == o.is_collide && is_crossing == o.is_crossing &&
           is_cut == o.is_cut && time == o.time && contacts == o.contacts;
  }
};

/// @brief A model with both frames.
std::shared_ptr<FuzzModel> makeFuzzModel(const MovingMesh& mesh);

/// @brief Gives the next frames. @throws std::runtime_error  they were refused
void updateFrames(FuzzModel& model, const MovingMesh& mesh);
/// @brief Gives the next mesh. @param origins  a hint, see updateTopology()
void updateTopology(FuzzModel& model, const MovingMesh& mesh,
                    const std::vector<int>& origins);

/// @brief The answer of a query, its time and its hash in the outcome.
/// @param b  null: the mesh with itself
MeshAnswer askModels(const FuzzModel& a, const FuzzModel* b, const MeshCase& what,
                     const Ask& ask, Outcome& outcome);

/// @brief The same, without a fault that is planted into answers.
MeshAnswer askUnplanted(const FuzzModel& a, const FuzzModel* b, const MeshCase& what,
                        const Ask& ask, Outcome& outcome);

/// @brief The same as askModels() with new models.
MeshAnswer askCase(const MeshCase& mesh_case, const Ask& ask, Outcome& outcome);

/// @brief Blames what the contacts of `found` lack, invent or have at other times.
/// @param tells  what the comparison is about
void expectSameContacts(std::vector<NamedBracket> found, std::vector<NamedBracket> truth,
                        bool with_times, const char* tells, Outcome& outcome);

}  // namespace test
}  // namespace fcl

#endif
