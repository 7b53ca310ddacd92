#include "framework/dynamics/law_list.h"

#include "framework/core/error.h"

namespace tumble {

void refuse_without_law(const std::string& where, const std::string& what,
                        const std::string& assignment) {
  throw UserError(
      where, "needs " + what + ", and no module provides it",
      "assignment " + assignment +
          " provides it: fill in that assignment first, or name a file that has it: --modules " +
          assignment + "=PATH");
}

void LawList::take_listed(const LawList& other, const std::string& source) {
  for (const Listed& theirs : other.listed_) {
    Listed& ours = at(*theirs.kind);
    ours.function = theirs.function;
    ours.source = source;
  }
}

void LawList::guard_listed() {
  for (Listed& listed : listed_) {
    const LawWords& words = listed.kind->words;
    listed.function = listed.kind->guarded(listed.function,
                                           LawGuard(words.effect, words.function, listed.source));
  }
}

LawList::Listed& LawList::at(const Kind& kind) {
  for (Listed& listed : listed_)
    if (listed.kind == &kind) return listed;
  return listed_.emplace_back(Listed{&kind, {}});
}

void LawList::remove(const Kind& kind) {
  std::erase_if(listed_, [&](const Listed& listed) { return listed.kind == &kind; });
}

}  // namespace tumble
