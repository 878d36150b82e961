/* The names that languages have for themselves. */
#ifndef GOPURA_UI_ENDONYM_H
#define GOPURA_UI_ENDONYM_H

/* Returns a language's own name, "ខ្មែរ" for "km". Returns the code itself if the name is
 * unknown. */
const char *ui_endonym(const char *language);

#endif
