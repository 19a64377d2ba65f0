"""PORT COUNT FRAMES: reads COUNT tags of the reader on PORT with pyllrp; prints them as JSON."""
import json
import sys

from pyllrp.LLRPConnector import LLRPConnector
from pyllrp.pyllrp import *

from llrp_tap import Tap


def ask(connector, message):
    response = connector.transact(message)
    assert response.success(), response
    return response


def ro_spec():
    return ADD_ROSPEC_Message(Parameters=[ROSpec_Parameter(ROSpecID=123, CurrentState=ROSpecState.Disabled, Parameters=[
        ROBoundarySpec_Parameter(Parameters=[
            ROSpecStartTrigger_Parameter(ROSpecStartTriggerType=ROSpecStartTriggerType.Immediate),
            ROSpecStopTrigger_Parameter(ROSpecStopTriggerType=ROSpecStopTriggerType.Null)]),
        AISpec_Parameter(AntennaIDs=[0], Parameters=[
            AISpecStopTrigger_Parameter(AISpecStopTriggerType=AISpecStopTriggerType.Null),
            InventoryParameterSpec_Parameter(InventoryParameterSpecID=1, ProtocolID=AirProtocols.EPCGlobalClass1Gen2)]),
        ROReportSpec_Parameter(ROReportTrigger=ROReportTriggerType.Upon_N_Tags_Or_End_Of_ROSpec, N=1, Parameters=[
            TagReportContentSelector_Parameter(EnableAntennaID=True, EnableChannelIndex=True, EnablePeakRSSI=True,
                                               EnableFirstSeenTimestamp=True, EnableTagSeenCount=True),
            ImpinjTagReportContentSelector_Parameter(Parameters=[
                ImpinjEnableRFPhaseAngle_Parameter(RFPhaseAngleMode=1),
                ImpinjEnablePeakRSSI_Parameter(PeakRSSIMode=1)])])])])


def tag_of(report):
    tag = {type(p): p for p in report.Parameters}
    return [HexFormatToStr(tag[EPC_96_Parameter].EPC).upper(), tag[ImpinjRFPhaseAngle_Parameter].PhaseAngle,
            tag[AntennaID_Parameter].AntennaID, tag[ChannelIndex_Parameter].ChannelIndex,
            tag[ImpinjPeakRSSI_Parameter].RSSI, tag[FirstSeenTimestampUTC_Parameter].Microseconds]


tap = Tap("127.0.0.1", int(sys.argv[1]))
count = int(sys.argv[2])
connector = LLRPConnector()
connector.connect("127.0.0.1", tap.port)
tags = []


def take(_, message):
    if isinstance(message, RO_ACCESS_REPORT_Message):
        tags.extend(tag_of(p) for p in message.Parameters if isinstance(p, TagReportData_Parameter))


connector.addHandler(RO_ACCESS_REPORT_Message, take)
ask(connector, IMPINJ_ENABLE_EXTENSIONS_Message(MessageID=1))
ask(connector, GET_READER_CAPABILITIES_Message(MessageID=2, RequestedData=0))
ask(connector, DELETE_ROSPEC_Message(MessageID=3, ROSpecID=0))
add = ro_spec()
add.MessageID = 4
ask(connector, add)
ask(connector, ENABLE_ROSPEC_Message(MessageID=5, ROSpecID=123))
while len(tags) < count:
    take(connector, UnpackMessageFromSocket(connector.readerSocket))
ask(connector, DISABLE_ROSPEC_Message(MessageID=6, ROSpecID=123))
connector.disconnect()
print(json.dumps(tags))
tap.write(sys.argv[3])
