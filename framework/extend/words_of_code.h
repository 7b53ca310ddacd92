/// Words and names as C++ and this house write them.
#pragma once

#include <string>
#include <vector>

namespace tumble::extend {

/// "mean_of" -> "MeanOf".
std::string pascal_case(const std::string& name);
/// "mean_of" -> "mean-of", for anchors.
std::string with_dashes(std::string name);
/// "mean_of" -> "Mean of".
std::string as_title(std::string name);
/// Reserved words of C++20 that look like a name.
bool is_word_of_cpp(const std::string& word);
/// Lower case words with _ between them, none of them reserved.
bool is_plain_name(const std::string& name);
std::vector<std::string> lines_of(const std::string& text);

}  // namespace tumble::extend
