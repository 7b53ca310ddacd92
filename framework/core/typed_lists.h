/// Lists of plain data, one for each type that is kept here. A scene and a world hold the entries
/// of their effects in it without knowing one of these types: each effect keeps its own.
#pragma once

#include <any>
#include <typeindex>
#include <vector>

namespace tumble {

class TypedLists {
 public:
  /// The list of a type; made, empty, where there is none.
  template <class Entry>
  std::vector<Entry>& of() {
    for (List& list : lists_)
      if (list.type == typeid(Entry)) return *std::any_cast<std::vector<Entry>>(&list.entries);
    lists_.push_back({typeid(Entry), std::vector<Entry>{}, [](const std::any& entries) {
                        return std::any_cast<std::vector<Entry>>(&entries)->empty();
                      }});
    return *std::any_cast<std::vector<Entry>>(&lists_.back().entries);
  }
  template <class Entry>
  const std::vector<Entry>& of() const {
    static const std::vector<Entry> none;
    for (const List& list : lists_)
      if (list.type == typeid(Entry)) return *std::any_cast<std::vector<Entry>>(&list.entries);
    return none;
  }

  /// The types of which there is an entry.
  std::vector<std::type_index> types() const {
    std::vector<std::type_index> found;
    for (const List& list : lists_)
      if (!list.is_empty(list.entries)) found.push_back(list.type);
    return found;
  }

 private:
  struct List {
    std::type_index type;
    std::any entries;  // a vector of the type
    bool (*is_empty)(const std::any&);
  };
  std::vector<List> lists_;  // a handful: looking through all of them is quickest
};

}  // namespace tumble
