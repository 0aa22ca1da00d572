#include "common/scene/error.h"

namespace vislab {

InputError unknown_name(const std::string& kind, const std::string& unknown,
                        const std::vector<std::string>& known) {
  std::string text = "`" + unknown + "` is not a " + kind + "; known: ";
  for (std::size_t i = 0; i < known.size(); ++i) text += (i == 0 ? "" : ", ") + known[i];
  if (known.empty()) text += "none";
  return InputError(text);
}

}  // namespace vislab
