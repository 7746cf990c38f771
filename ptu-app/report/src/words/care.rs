//! The care of the history: exchange with a server, import, backup, check.

use fault_db::SyncPhase;

use super::wordings;

wordings! {
    /// The care of the history: exchange with a server, import, backup, check.
    Care {
        title: "History", "이력 관리";
        file: "history file", "이력 파일";
        server: "server", "서버";
        address_hint: "postgres://USER@HOST/DATABASE; a password is kept in the password file of PostgreSQL", "postgres://USER@HOST/DATABASE. 비밀번호는 PostgreSQL 비밀번호 파일에 둡니다";
        never_synced: "not synced with a server yet", "서버와 동기화한 적 없음";
        last_synced: "last synced {at} with {server}; entries that wait: {n}", "최근 동기화 {at}, 서버 {server}. 대기 중인 기록 {n}건";
        sync: "Sync", "동기화";
        with_traces: "with traces", "신호 기록 포함";
        sending: "sending runs and events: {done} of {total}", "시험과 이벤트 보내는 중: {total}건 중 {done}건";
        sending_traces: "sending traces: {done} of {total}", "신호 기록 보내는 중: {total}건 중 {done}건";
        receiving: "receiving events: {done}", "이벤트 받는 중: {done}건";
        connecting: "connecting to the server …", "서버에 연결하는 중 …";
        synced: "Sent: {runs} runs, {occurrences} occurrences, {events} events, {notes} notes, {traces} traces. Received: {received} events on {faults} faults", "보냄: 시험 {runs}건, 발생 {occurrences}건, 이벤트 {events}건, 메모 {notes}건, 신호 기록 {traces}건. 받음: 고장 {faults}건의 이벤트 {received}건";
        waiting: "{n} entries wait for the next sync", "{n}건은 다음 동기화 때 보냅니다";
        stopped: "Stopped. The next sync goes on from here", "중지됨. 다음 동기화 때 이어서 합니다";
        nothing_done: "Stopped. Nothing was changed", "중지됨. 변경된 것이 없습니다";
        clocks_differ: "The clocks of this computer and of the server differ by {n} s: set this one", "이 컴퓨터와 서버의 시계가 {n}초 차이 납니다. 이 컴퓨터의 시계를 맞추십시오";
        different: "{what} {id} does not say the same on both sides; each side keeps its own. Check the history", "양쪽에서 내용이 다름: {what} {id}. 양쪽 모두 그대로 두었습니다. 이력을 검사하십시오";
        damaged_trace: "trace {id} is damaged and was not sent. Check the history", "신호 기록 {id}이(가) 손상되어 보내지 않았습니다. 이력을 검사하십시오";
        refused: "Not taken, as its content is impossible: {what}", "내용이 잘못되어 받지 않음: {what}";
        refused_more: "{n} more were not taken", "그 밖에 {n}건을 받지 않았습니다";
        conflict: "Conflict: unit {unit}, {fault}: {rivals}. It stays \"{stands}\" until somebody decides", "충돌: 장치 {unit}, {fault}: {rivals}. 담당자가 정할 때까지 \"{stands}\" 상태로 둡니다";
        says: "{who}: {state}", "{who}: {state}";
        other_file: "file", "파일";
        import: "Import another history", "다른 이력 가져오기";
        importing: "importing {file} …", "{file} 가져오는 중 …";
        imported: "Added: {runs} runs, {steps} steps, {faults} faults, {occurrences} occurrences, {traces} traces", "추가됨: 시험 {runs}건, 단계 {steps}건, 고장 {faults}건, 발생 {occurrences}건, 신호 기록 {traces}건";
        copy: "It is a copy of this history or of one that is known here (database {file})", "이 이력 또는 이미 가져온 이력의 사본입니다 (데이터베이스 {file})";
        backup: "Back up", "백업";
        backing_up: "copying to {file} …", "{file}(으)로 복사하는 중 …";
        backed_up: "Copied to {file}", "{file}(으)로 복사함";
        check: "Check", "검사";
        checking: "checking the history …", "이력을 검사하는 중 …";
        sound: "No damage. Traces read: {traces}; runs that fit their seals: {runs}", "손상 없음. 읽은 신호 기록 {traces}건, 봉인과 일치하는 시험 {runs}건";
        damaged: "Problems: {n}", "문제 {n}건";
        chain: "chain of seals: {n} entries of database {file}, the last {seal}", "봉인 사슬: 데이터베이스 {file}의 기록 {n}건, 마지막 봉인 {seal}";
        logs: "Logs and run records of a unit are imported on the pages {faults} and {traces}.", "장치의 로그와 주행 기록은 {faults}, {traces} 화면에서 가져옵니다.";
        failed: "The history was not exchanged, copied or checked", "이력을 교환, 복사 또는 검사하지 못했습니다";
        reads: "reads only: {server}", "읽기 전용: {server}";
        is_server: "This window reads the history of a server. Runs, repairs and notes are recorded in the file of a laptop: open the window with it, and sync it.", "이 창은 서버의 이력을 읽기만 합니다. 시험, 수리, 메모는 노트북의 이력 파일에 기록됩니다. 그 파일로 창을 열고 동기화하십시오.";
    }
}

impl Care {
    /// How far a sync is.
    pub fn phase(&self, phase: SyncPhase) -> &'static str {
        match phase {
            SyncPhase::Sending => self.sending,
            SyncPhase::SendingTraces => self.sending_traces,
            SyncPhase::Receiving => self.receiving,
        }
    }
}
