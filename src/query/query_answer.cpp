// SPDX-License-Identifier: BSD-3-Clause
#include "query/query_answer.h"

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <limits>
#include <utility>

#include "mesh/non_finite_vertex.h"
#include "query/leading_contact.h"
#include "query/task_findings.h"

namespace fcl {
namespace detail {
namespace deformable {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// @param latest  later errors do not matter
void throwError(const std::vector<TaskAnswer>& tasks, double latest,
                const QueryProgress& progress) {
  const std::size_t last = progress.answered_by.load();
  const QueryError* earliest = nullptr;
  for (std::size_t i = 0; i < tasks.size() && i <= last; ++i) {
    const std::optional<QueryError>& error = tasks[i].error;
    if (error && error->earliest <= latest &&
        (!earliest || error->earliest < earliest->earliest))
      earliest = &*error;
  }
  if (earliest) throw NonFiniteVertex(earliest->mesh, earliest->vertex);
}

void addEffort(const std::vector<TaskAnswer>& tasks, QueryAnswer& answer) {
  for (const TaskAnswer& task : tasks) {
    answer.counts += task.counts;
    answer.times.traverse += task.times.traverse;
    answer.times.test += task.times.test;
  }
}

/// Takes the crossings of the first task that has one, or of all tasks.
void takeCrossings(const std::vector<TaskAnswer>& tasks, bool all, QueryAnswer& answer) {
  for (const TaskAnswer& task : tasks)
    if (all || !answer.hasCrossing())
      answer.crossings.insert(answer.crossings.end(), task.crossings.begin(),
                              task.crossings.end());
  if (all) sortCrossings(answer.crossings);
}

SortedContacts sorted(std::deque<FeatureContact> contacts) {
  std::vector<std::deque<FeatureContact>> lists;
  lists.push_back(std::move(contacts));
  return SortedContacts(std::move(lists));
}

/// Takes the crossing and the earliest contact of the first task that has either.
void takeAny(const std::vector<TaskAnswer>& tasks, QueryAnswer& answer) {
  for (const TaskAnswer& task : tasks) {
    if (task.crossings.empty() && !task.contacts) continue;
    answer.crossings = task.crossings;
    if (!task.contacts) return;
    ContactSink sink(1, false);
    for (const FeatureContact& contact : *task.contacts) sink.add(contact);
    answer.contacts = sorted(sink.takeContacts());
    return;
  }
}

using ContactLists = std::vector<std::deque<FeatureContact>>;

/// Takes the earliest max_contacts of the contacts whose brackets begin no later than
/// `latest`.
/// @param may_repeat, has_parts  whether several tasks may have found a contact, or one
/// of parts of features
ContactLists takeUntil(double latest, std::vector<TaskAnswer>& tasks,
                       std::size_t max_contacts, bool may_repeat, bool has_parts,
                       QueryAnswer& answer) {
  ContactLists lists;
  lists.reserve(tasks.size());  // to grow would copy the contacts
  for (TaskAnswer& task : tasks) {
    if (!task.contacts) continue;
    std::deque<FeatureContact>& list = lists.emplace_back(std::move(*task.contacts));
    if (latest < 1)
      list.erase(std::remove_if(list.begin(), list.end(),
                                [&](const auto& c) { return c.toc_lo > latest; }),
                 list.end());
  }
  if (may_repeat || has_parts) dropRepeats(may_repeat, lists);
  std::size_t count = 0;
  for (const auto& list : lists) count += list.size();
  if (count <= max_contacts) return lists;
  ContactSink sink(max_contacts, false);
  for (const auto& list : lists)
    for (const FeatureContact& contact : list) sink.add(contact);
  answer.cut = true;
  lists.assign(1, sink.takeContacts());
  return lists;
}

TimeBracket firstListed(const QueryAnswer& answer) {
  if (answer.contacts.empty()) return {1, 1};
  return {answer.contacts.front().toc_lo, answer.contacts.front().toc_hi};
}

/// The latest beginning of a bracket.
double latestOf(const ContactLists& contacts) {
  double latest = 0;
  for (const auto& list : contacts)
    for (const FeatureContact& contact : list) latest = std::max(latest, contact.toc_lo);
  return latest;
}

/// Whether the first contact is certainly among those that were kept. It is, if a contact
/// with the earliest upper end is among them, and the latest of them begins no earlier
/// than that end: contacts that were dropped begin no earlier either.
bool isFirstKept(double first_hi, const ContactLists& contacts) {
  bool is_kept = false;
  for (const auto& list : contacts)
    for (const FeatureContact& contact : list) is_kept |= contact.toc_hi == first_hi;
  return is_kept && latestOf(contacts) >= first_hi;
}

}  // namespace

void TaskAnswer::take(TaskFindings& findings) {
  cut = findings.sink().isCut();
  crossings = findings.crossings();
  if (!findings.sink().contacts().empty()) contacts = findings.sink().takeContacts();
  error = findings.error();
  counts = findings.counts();
}

QueryAnswer merge(std::vector<TaskAnswer>& tasks, const QueryOptions& options,
                  const QueryProgress& progress, const MeshInstance& a,
                  const MeshInstance& b,
                  const std::function<FeatureContact()>& firstContact) {
  assert(!tasks.empty());
  const double first_hi = progress.first_hi.load();
  const bool is_first = options.query == ContinuousQuery::kFirst,
             is_all = options.query == ContinuousQuery::kAll;
  if (!is_all) throwError(tasks, is_first ? first_hi : kInfinity, progress);
  QueryAnswer answer;
  addEffort(tasks, answer);
  if (options.query == ContinuousQuery::kAny) {
    takeAny(tasks, answer);
    answer.first = firstListed(answer);
    return answer;
  }
  takeCrossings(tasks, options.all_crossings, answer);
  const bool at_distance = options.min_distance > 0;
  const bool may_repeat = !a.hasOwners() || !b.hasOwners();
  ContactLists contacts = takeUntil(is_first ? first_hi : 1, tasks, options.max_contacts,
                                    may_repeat, at_distance, answer);
  if (is_all) {
    for (const TaskAnswer& task : tasks) answer.cut |= task.cut;
    throwError(tasks, answer.cut ? latestOf(contacts) : kInfinity, progress);
    if (answer.cut && !at_distance && !isFirstKept(first_hi, contacts)) {
      const FeatureContact first = firstContact();
      answer.first = {first.toc_lo, first.toc_hi};
    } else if (std::any_of(contacts.begin(), contacts.end(),
                           [](const auto& list) { return !list.empty(); }) &&
               !at_distance) {
      answer.first = bracketOfFirst(a, b, first_hi, contacts);
    }
  }
  answer.contacts = SortedContacts(std::move(contacts));
  assert(answer.contacts.size() <= options.max_contacts);
  // With a distance all brackets are tight.
  if (options.query == ContinuousQuery::kFirst || at_distance)
    answer.first = firstListed(answer);
  assert(0 <= answer.first.lo && answer.first.lo <= answer.first.hi &&
         answer.first.hi <= 1);
  return answer;
}

}  // namespace deformable
}  // namespace detail
}  // namespace fcl
