//! Stored memory of a unit, read by a button.

use super::wordings;

wordings! {
    /// Stored memory of a unit.
    Memory {
        title: "Records kept in the unit", "장치에 저장된 기록";
        import: "Import the unit's log", "장치 기록 가져오기";
        pull: "Pull the run record", "주행 기록 가져오기";
        compare: "Compare with a sound run", "정상 주행과 비교";
        reading: "reading {unit} …", "{unit} 읽는 중 …";
        comparing: "driving a sound unit through the section …", "정상 장치로 같은 구간을 주행하는 중 …";
        stop: "Stop", "중지";
        imported: "{unit}: {entries} log entries read, {new} new faults, {known} known already", "{unit}: 기록 {entries}건 읽음, 새 고장 {new}건, 이미 아는 고장 {known}건";
        pulled: "{unit}: {rows} rows read, {new} new runs, {known} known already", "{unit}: 주행 기록 {rows}행 읽음, 새 주행 {new}건, 이미 아는 주행 {known}건";
        failed: "The unit's memory was not read to its end", "장치 저장 기록을 끝까지 읽지 못했습니다";
        not_compared: "The run was not compared", "주행을 비교하지 못했습니다";
        on_port_only: "choose a unit on a port: the simulated one keeps nothing from run to run", "포트에 연결된 장치를 고르십시오. 내장 장치는 시험이 끝나면 기록을 남기지 않습니다";
        disconnect_first: "disconnect the unit first: its port has one reader at a time", "먼저 장치 연결을 끊으십시오. 포트는 한 번에 한 곳에서만 읽습니다";
    }
}
