// SPDX-License-Identifier: BSD-3-Clause
//
// The answers for the objects of a scene file as table, CSV and JSON.
#ifndef FCL_CCD_SCENE_REPORT_H
#define FCL_CCD_SCENE_REPORT_H

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "json.h"
#include "scene_objects.h"

namespace fcl_ccd {

/// @brief Two objects in contact in a step.
struct ObjectsInContact {
  std::size_t o1{0}, o2{0};
  double time{0};  ///< of the first contact
  /// The crossings at the beginning of the step, then the others by their time.
  std::vector<fcl::ContinuousContactd> contacts;
};

/// @brief The answer of a step.
struct ObjectsStep {
  std::size_t number{0};
  std::size_t num_box_pairs{0};
  std::vector<ObjectsInContact> pairs;  ///< by their time
  double ms{0};

  std::size_t numContacts() const;
};

/// @brief The answer of the manager as it is reported.
ObjectsStep toStep(std::size_t number, fcl::ContinuousManagerResultd result,
                   const SceneObjects& objects);

/// @brief What is known of a scene after its steps.
struct ObjectsSummary {
  std::size_t steps{0};
  std::size_t contacts{0};
  std::string first_sentence;  ///< empty without contact
  Json first = nullptr;
  std::size_t slowest_step{0};
  double slowest_ms{-1};

  /// @brief Adds a step that is after all others.
  void add(const ObjectsStep& step, const SceneObjects& objects,
           fcl::ContinuousQuery query);
};

/// @brief Head and rows of the table, each with its line end. A line has at most 80
/// characters, unless a number is longer than its column.
std::string objectsTableHead(fcl::ContinuousQuery query);
std::string objectsTableRow(const ObjectsStep& step);

/// @brief The summary as lines for the terminal.
std::string summaryLines(const ObjectsSummary& summary, fcl::ContinuousQuery query);

/// @brief Head and lines of the contact list.
std::string objectsContactsHead();
std::string contactLines(const ObjectsStep& step, const SceneObjects& objects);

/// @brief Parts of the JSON file: the list of objects, a step, the summary.
Json objectsJson(const SceneObjects& objects);
Json toJson(const ObjectsStep& step, const SceneObjects& objects);
Json toJson(const ObjectsSummary& summary);

}  // namespace fcl_ccd

#endif
