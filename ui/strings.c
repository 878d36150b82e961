#include "ui/strings.h"

#include <string.h>

#include "base/compiler.h"

static const struct {
	const char *language, *strings[UI_STRING_COUNT];
} tables[] = {
	{ "en",
	  { "Read more", "Close", "Drag to turn", "Pinch to come nearer", "Tap a name to read",
	    "Touch to explore", "Are you still there?", "In %d seconds it begins anew.", "Go on",
	    "Search", "Nothing found", "Guided tours", "Raking light", "Section" } },
	{ "fr",
	  { "Lire la suite", "Fermer", "Glissez pour tourner", "Écartez pour approcher",
	    "Touchez un nom pour lire", "Touchez pour explorer", "Êtes-vous toujours là ?",
	    "Retour au début dans %d secondes.", "Continuer", "Chercher", "Aucun résultat",
	    "Visites guidées", "Lumière rasante", "Coupe" } },
	{ "km",
	  { "អានបន្ថែម", "បិទ", "អូសដើម្បីបង្វិល", "ច្បិចដើម្បីពង្រីក", "ប៉ះឈ្មោះដើម្បីអាន", "ប៉ះដើម្បីស្វែងយល់",
	    "តើអ្នកនៅទីនេះទេ?", "នឹងចាប់ផ្តើមឡើងវិញក្នុង %d វិនាទី។", "បន្ត", "ស្វែងរក", "រកមិនឃើញ", "ដំណើរទស្សនា",
	    "ពន្លឺចំហៀង", "មុខកាត់" } },
	{ "ja",
	  { "詳しく読む", "閉じる", "なぞって回す", "つまんで拡大", "名前にふれて読む",
	    "さわってご覧ください", "まだご覧になっていますか？", "あと%d秒で最初にもどります。",
	    "つづける", "さがす", "見つかりません", "ガイドツアー", "斜光", "断面" } },
	{ "ar",
	  { "اقرأ المزيد", "إغلاق", "اسحب للتدوير", "باعد بين إصبعيك للاقتراب", "المس اسمًا للقراءة",
	    "المس للاستكشاف", "هل ما زلت هنا؟", "يعود إلى البداية بعد %d ثانية.", "متابعة", "بحث",
	    "لا نتائج", "جولات إرشادية", "ضوء مائل", "مقطع" } },
	{ "th",
	  { "อ่านต่อ", "ปิด", "ลากเพื่อหมุน", "กางนิ้วเพื่อเข้าใกล้", "แตะชื่อเพื่ออ่าน", "แตะเพื่อสำรวจ", "คุณยังอยู่ไหม",
	    "จะกลับไปเริ่มต้นใหม่ใน %d วินาที", "ดูต่อ", "ค้นหา", "ไม่พบ", "ทัวร์นำชม", "แสงเฉียง", "ภาพตัด" } },
	{ "hi",
	  { "और पढ़ें", "बंद करें", "घुमाने के लिए खींचें", "पास आने के लिए उँगलियाँ फैलाएँ", "पढ़ने के लिए नाम छुएँ",
	    "देखने के लिए छुएँ", "क्या आप अब भी यहाँ हैं?", "%d सेकंड में फिर से शुरू होगा।", "जारी रखें", "खोजें",
	    "कुछ नहीं मिला", "निर्देशित सैर", "तिरछी रोशनी", "काट" } },
};

static const struct {
	const char *language, *name;
} endonyms[] = {
	{ "en", "English" },    { "fr", "Français" }, { "km", "ខ្មែរ" },       { "ja", "日本語" },
	{ "de", "Deutsch" },    { "es", "Español" },  { "it", "Italiano" },   { "pt", "Português" },
	{ "nl", "Nederlands" }, { "th", "ไทย" },      { "vi", "Tiếng Việt" }, { "lo", "ລາວ" },
	{ "my", "မြန်မာ" },      { "zh", "中文" },     { "ko", "한국어" },     { "ru", "Русский" },
	{ "ar", "العربية" },    { "hi", "हिन्दी" },
};

const char *ui_string(enum ui_string string, const char *language)
{
	for (size_t i = 0; i < ARRAY_COUNT(tables); i++)
		if (strcmp(tables[i].language, language) == 0)
			return tables[i].strings[string];
	return tables[0].strings[string];
}

const char *ui_endonym(const char *language)
{
	for (size_t i = 0; i < ARRAY_COUNT(endonyms); i++)
		if (strcmp(endonyms[i].language, language) == 0)
			return endonyms[i].name;
	return language;
}
