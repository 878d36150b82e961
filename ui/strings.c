/* Tables of the kiosk's own texts by language, and of the languages' own names. */
#include "ui/strings.h"

#include <stdbool.h>
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
	{ "de",
	  { "Mehr lesen", "Schließen", "Ziehen zum Drehen", "Finger spreizen zum Annähern",
	    "Namen antippen zum Lesen", "Zum Entdecken berühren", "Sind Sie noch da?",
	    "In %d Sekunden beginnt es von vorn.", "Weiter", "Suchen", "Nichts gefunden",
	    "Führungen", "Streiflicht", "Schnitt" } },
	{ "es",
	  { "Leer más", "Cerrar", "Arrastre para girar", "Separe los dedos para acercarse",
	    "Toque un nombre para leer", "Toque para explorar", "¿Sigue ahí?",
	    "Vuelve al inicio en %d segundos.", "Continuar", "Buscar", "Sin resultados",
	    "Visitas guiadas", "Luz rasante", "Sección" } },
	{ "it",
	  { "Continua a leggere", "Chiudi", "Trascina per girare",
	    "Allarga le dita per avvicinarti", "Tocca un nome per leggere", "Tocca per esplorare",
	    "Sei ancora qui?", "Si ricomincia tra %d secondi.", "Continua", "Cerca",
	    "Nessun risultato", "Visite guidate", "Luce radente", "Sezione" } },
	{ "pt",
	  { "Ler mais", "Fechar", "Arraste para girar", "Afaste os dedos para aproximar",
	    "Toque num nome para ler", "Toque para explorar", "Ainda está aí?",
	    "Recomeça em %d segundos.", "Continuar", "Pesquisar", "Nada encontrado",
	    "Visitas guiadas", "Luz rasante", "Corte" } },
	{ "nl",
	  { "Lees meer", "Sluiten", "Sleep om te draaien",
	    "Spreid de vingers om dichterbij te komen", "Tik op een naam om te lezen",
	    "Raak aan om te ontdekken", "Bent u er nog?", "Over %d seconden begint het opnieuw.",
	    "Verder", "Zoeken", "Niets gevonden", "Rondleidingen", "Strijklicht", "Doorsnede" } },
	{ "pl",
	  { "Czytaj dalej", "Zamknij", "Przeciągnij, aby obrócić", "Rozsuń palce, aby przybliżyć",
	    "Dotknij nazwy, aby przeczytać", "Dotknij, aby zwiedzać", "Czy nadal tu jesteś?",
	    "Za %d s zacznie się od nowa.", "Dalej", "Szukaj", "Nic nie znaleziono", "Wycieczki",
	    "Światło boczne", "Przekrój" } },
	{ "ru",
	  { "Читать дальше", "Закрыть", "Ведите пальцем, чтобы повернуть",
	    "Раздвиньте пальцы, чтобы приблизить", "Коснитесь названия, чтобы прочитать",
	    "Коснитесь, чтобы начать осмотр", "Вы ещё здесь?", "Через %d с всё начнётся сначала.",
	    "Продолжить", "Поиск", "Ничего не найдено", "Экскурсии", "Косой свет", "Разрез" } },
	{ "zh",
	  { "阅读更多", "关闭", "拖动以旋转", "张开两指以靠近", "点按名称以阅读", "触摸开始探索",
	    "您还在吗？", "%d 秒后重新开始。", "继续", "搜索", "未找到", "导览", "侧光", "剖面" } },
	{ "ko",
	  { "더 읽기", "닫기", "끌어서 돌리기", "두 손가락을 벌려 다가가기", "이름을 눌러 읽기",
	    "화면을 눌러 둘러보세요", "아직 계신가요?", "%d초 후에 처음으로 돌아갑니다.", "계속",
	    "검색", "결과 없음", "안내 관람", "측면 조명", "단면" } },
	{ "vi",
	  { "Đọc thêm", "Đóng", "Kéo để xoay", "Tách hai ngón để lại gần", "Chạm vào tên để đọc",
	    "Chạm để khám phá", "Bạn còn ở đó không?", "Sẽ bắt đầu lại sau %d giây.", "Tiếp tục",
	    "Tìm kiếm", "Không tìm thấy", "Tham quan có hướng dẫn", "Ánh sáng xiên", "Mặt cắt" } },
	{ "id",
	  { "Baca selengkapnya", "Tutup", "Geser untuk memutar",
	    "Renggangkan dua jari untuk mendekat", "Ketuk nama untuk membaca",
	    "Sentuh untuk menjelajah", "Masih di sini?", "Dalam %d detik dimulai lagi.",
	    "Lanjutkan", "Cari", "Tidak ditemukan", "Tur berpemandu", "Cahaya samping",
	    "Potongan" } },
	{ "tr",
	  { "Devamını oku", "Kapat", "Döndürmek için sürükleyin", "Yaklaşmak için parmakları açın",
	    "Okumak için bir ada dokunun", "Keşfetmek için dokunun", "Hâlâ orada mısınız?",
	    "%d saniye sonra baştan başlar.", "Devam", "Ara", "Sonuç yok", "Rehberli turlar",
	    "Yandan ışık", "Kesit" } },
};

static const struct {
	const char *language, *name;
} endonyms[] = {
	{ "en", "English" },
	{ "fr", "Français" },
	{ "km", "ខ្មែរ" },
	{ "ja", "日本語" },
	{ "de", "Deutsch" },
	{ "es", "Español" },
	{ "it", "Italiano" },
	{ "pt", "Português" },
	{ "nl", "Nederlands" },
	{ "th", "ไทย" },
	{ "vi", "Tiếng Việt" },
	{ "lo", "ລາວ" },
	{ "my", "မြန်မာ" },
	{ "zh", "中文" },
	{ "ko", "한국어" },
	{ "ru", "Русский" },
	{ "ar", "العربية" },
	{ "hi", "हिन्दी" },
	{ "zh-Hans", "简体中文" },
	{ "zh-Hant", "繁體中文" },
	{ "zh-CN", "简体中文" },
	{ "zh-TW", "繁體中文" },
	{ "zh-HK", "繁體中文（香港）" },
	{ "pt-BR", "Português (Brasil)" },
	{ "id", "Bahasa Indonesia" },
	{ "ms", "Bahasa Melayu" },
	{ "tr", "Türkçe" },
	{ "he", "עברית" },
	{ "fa", "فارسی" },
	{ "ur", "اردو" },
	{ "ta", "தமிழ்" },
	{ "el", "Ελληνικά" },
	{ "uk", "Українська" },
	{ "bg", "Български" },
	{ "sr", "Српски" },
	{ "pl", "Polski" },
	{ "cs", "Čeština" },
	{ "sk", "Slovenčina" },
	{ "hu", "Magyar" },
	{ "ro", "Română" },
	{ "sl", "Slovenščina" },
	{ "hr", "Hrvatski" },
	{ "sv", "Svenska" },
	{ "da", "Dansk" },
	{ "nb", "Norsk" },
	{ "no", "Norsk" },
	{ "fi", "Suomi" },
	{ "et", "Eesti" },
	{ "lv", "Latviešu" },
	{ "lt", "Lietuvių" },
	{ "is", "Íslenska" },
	{ "ca", "Català" },
	{ "eu", "Euskara" },
	{ "gl", "Galego" },
	{ "ga", "Gaeilge" },
	{ "cy", "Cymraeg" },
	{ "ne", "नेपाली" },
	{ "mr", "मराठी" },
	{ "tl", "Tagalog" },
};

/* Returns true if wider is language or its prefix, as "pt" is for "pt-BR". */
static bool is_kind_of(const char *language, const char *wider)
{
	const size_t size = strlen(wider);

	return strncmp(language, wider, size) == 0 && (!language[size] || language[size] == '-');
}

const char *ui_string(enum ui_string string, const char *language)
{
	for (size_t i = 0; i < ARRAY_COUNT(tables); i++)
		if (is_kind_of(language, tables[i].language))
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
