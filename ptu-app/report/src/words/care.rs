//! Maintenance of the history: exchange with a server, import, backup, check.

use fault_db::SyncPhase;

use super::wordings;

wordings! {
    /// Maintenance of the history: exchange with a server, import, backup, check.
    HistoryMaintenance {
        title: "History", "이력 관리";
        file: "history file", "이력 파일";
        server: "server", "서버";
        address_hint: "postgres://USER@HOST/DATABASE; a password is kept in the password file of PostgreSQL", "postgres://USER@HOST/DATABASE. 비밀번호는 PostgreSQL 비밀번호 파일에 둡니다";
        never_synced: "not synced with a server yet", "서버와 동기화한 적 없음";
        last_synced: "last synced {at} with {server}; entries that wait: {n}", "최근 동기화 {at}, 서버 {server}. 대기 중인 기록 {n}건";
        under_way: "work is under way", "작업이 진행 중입니다";
        sync: "Sync", "동기화";
        with_traces: "with traces", "신호 기록 포함";
        sending: "sending runs and events", "시험과 이벤트 보내는 중";
        sending_traces: "sending traces", "신호 기록 보내는 중";
        receiving: "receiving events", "이벤트 받는 중";
        connecting: "connecting to the server …", "서버에 연결하는 중 …";
        synced: "sent {runs} runs, {occurrences} occurrences, {events} events, {notes} notes, {traces} traces; received {received} events on {faults} faults", "보냄: 시험 {runs}건, 발생 {occurrences}건, 이벤트 {events}건, 메모 {notes}건, 신호 기록 {traces}건. 받음: 고장 {faults}건의 이벤트 {received}건";
        already_there: "; {n} entries were there already", ". 이미 있던 기록 {n}건";
        took: "{mb} MB in {s} s", "{mb} MB, {s} s";
        waiting: "{n} entries wait for the next sync", "{n}건은 다음 동기화 때 보냅니다";
        stopped: "stopped; the next sync goes on from here", "중지됨. 다음 동기화 때 이어서 합니다";
        nothing_done: "Stopped. Nothing was changed", "중지됨. 변경된 것이 없습니다";
        clock_ahead: "this computer's clock is {span} ahead of the server's; set it, or its times will puzzle people", "이 컴퓨터의 시계가 서버보다 {span} 빠릅니다. 시계를 맞추십시오";
        clock_behind: "this computer's clock is {span} behind the server's; set it, or its times will puzzle people", "이 컴퓨터의 시계가 서버보다 {span} 느립니다. 시계를 맞추십시오";
        different: "{what} {id} does not say the same on both sides; each side keeps its own: check the history", "양쪽에서 내용이 다름: {what} {id}. 양쪽 모두 그대로 두었습니다. 이력을 검사하십시오";
        forked: "of database {id}, whose runs came here, the server knows another history: one of them is a copy that went on by itself; check the history", "여기에 시험을 보낸 데이터베이스 {id}의 이력이 서버에서는 다릅니다. 둘 중 하나는 따로 이어진 사본입니다. 이력을 검사하십시오";
        damaged_trace: "trace {id} is damaged and was not sent; check the history", "신호 기록 {id}이(가) 손상되어 보내지 않았습니다. 이력을 검사하십시오";
        refused: "refused {what}: {why}", "받지 않음: {what} ({why})";
        refused_count: "; refused {n}", ". 받지 않음 {n}건";
        refused_more: "refused {n} more", "그 밖에 {n}건을 받지 않았습니다";
        conflict: "fault {id} ({unit}, {fault}): {rivals}; it stays {stands} until somebody looks again", "고장 {id} ({unit}, {fault}): {rivals}. 담당자가 정할 때까지 \"{stands}\" 상태로 둡니다";
        says: "{who} says {state}", "{who}: {state}";
        other_file: "file", "파일";
        import: "Import another history", "다른 이력 가져오기";
        importing: "importing {file} …", "{file} 가져오는 중 …";
        imported: "added {runs} runs, {steps} steps, {faults} faults, {occurrences} occurrences, {traces} traces", "추가됨: 시험 {runs}건, 단계 {steps}건, 고장 {faults}건, 발생 {occurrences}건, 신호 기록 {traces}건";
        copy_went_on: "it is a copy of database {file} that went on by itself after entry {n} of its chain of seals; what is new in it is sealed here as it was found", "데이터베이스 {file}의 사본이며 봉인 사슬의 {n}번째 기록 이후 따로 이어졌습니다. 새로 들어온 내용은 들어온 그대로 여기에서 봉인했습니다";
        copy_before: "it is a copy of database {file} from before: more of its chain of seals is known here than the {n} entries in it", "데이터베이스 {file}의 이전 사본입니다. 여기에서 아는 봉인 사슬은 사본의 {n}건보다 깁니다";
        backup: "Back up", "백업";
        backing_up: "copying to {file} …", "{file}(으)로 복사하는 중 …";
        backed_up: "copied to {file}", "{file}(으)로 복사함";
        check: "Check", "검사";
        checking: "checking the history …", "이력을 검사하는 중 …";
        sound: "no damage; {traces} traces read, {runs} runs fit their seals", "손상 없음. 신호 기록 {traces}건 읽음, 봉인과 맞는 시험 {runs}건";
        older_version: "{file} is of an earlier version of this program: a copy that was brought up to date was checked", "{file}은(는) 이 프로그램의 이전 버전에서 만든 것이라, 형식을 올린 사본을 검사했습니다";
        damaged: "Problems: {n}", "문제 {n}건";
        chain: "chain of seals: {n} entries of database {file}, the last {seal}", "봉인 사슬: 데이터베이스 {file}의 기록 {n}건, 마지막 {seal}";
        pruned: "{n} traces ({bytes} bytes) deleted, {kept} kept for faults that are not closed", "신호 기록 {n}건 ({bytes} B) 삭제함. 종결되지 않은 고장의 {kept}건은 남김";
        would_prune: "{n} traces ({bytes} bytes) would go, {kept} kept for faults that are not closed", "신호 기록 {n}건 ({bytes} B)을 삭제하게 됨. 종결되지 않은 고장의 {kept}건은 남김";
        kept_unsent: ", {n} kept until a sync has sent them", ". 동기화로 보내지 않은 {n}건은 남김";
        freed: ", file {bytes} bytes smaller", ". 파일이 {bytes} B 작아짐";
        still_over: "it is still {bytes} bytes larger than it may be: the rest is runs, faults and traces that are kept", "아직 {bytes} B 더 큼. 나머지는 남겨 두는 시험, 고장, 신호 기록임";
        would_be_over: "it would still be {bytes} bytes larger than it may be: the rest is runs, faults and traces that are kept", "그래도 {bytes} B 더 큼. 나머지는 남겨 두는 시험, 고장, 신호 기록임";
        rebuilt: "counts by day and month, repairs, sums of measured values and search words made again; runs, faults, traces and seals are as they were", "일별·월별 집계, 수리, 측정값 합계, 검색어를 다시 만들었습니다. 시험, 고장, 신호 기록, 봉인은 그대로입니다";
        differed: "until now, and on record from now on:", "지금까지 달랐던 것 (이제 기록됨):";
        tables: "{written} files written below {folder}, {unchanged} unchanged, {removed} removed; for DuckDB: views.sql there", "{folder}에 파일 {written}개 기록, {unchanged}개 그대로, {removed}개 삭제. DuckDB에서는 그곳의 views.sql을 사용하십시오";
        logs: "Logs and run records of a unit are imported on the pages {faults} and {traces}.", "장치의 로그와 주행 기록은 {faults}, {traces} 화면에서 가져옵니다.";
        failed: "The history was not exchanged, copied or checked", "이력을 교환, 복사 또는 검사하지 못했습니다";
        reads: "reads only: {server}", "읽기 전용: {server}";
        is_server: "This window reads the history of a server. Runs, repairs and notes are recorded in the file of a laptop: open the window with it, and sync it.", "이 창은 서버의 이력을 읽기만 합니다. 시험, 수리, 메모는 노트북의 이력 파일에 기록됩니다. 그 파일로 창을 열고 동기화하십시오.";
    }
}

impl HistoryMaintenance {
    pub fn phase(&self, phase: SyncPhase) -> &'static str {
        match phase {
            SyncPhase::Sending => self.sending,
            SyncPhase::SendingTraces => self.sending_traces,
            SyncPhase::Receiving => self.receiving,
        }
    }
}
